#include "pcm/ops/shared/neighbour_arguments.h"

#include "pcm/cluster/filter/team_attributes.h"
#include "pcm/ops/shared/attribute_report.h"
#include "pcm/tree/tree.h"

namespace pcm::ops {

void NeighbourArguments::declare(Arguments& arguments, const std::string& meaning)
{
    arguments.add("neighbours", neighbours)
        .letter('k')
        .between(1, most_neighbours)
        .label("Neighbours")
        .help("Number of nearest neighbours " + meaning + ", without the point itself");
    arguments.add("max_distance", max_distance)
        .positive()
        .unit("source units")
        .label("Farthest neighbour")
        .help("Neighbours that are farther from the point do not count")
        .without("none")
        .advanced();
    work.declare(arguments, least_attribute_memory);
    flann_argument(arguments, flann);
}

void NeighbourArguments::put_into(NeighbourAttributeOptions& options, const std::string& called_memory) const
{
    work.keep_memory_limit(called_memory);
    options.neighbours = neighbours;
    if (max_distance) options.max_distance = *max_distance;
    options.memory_bytes = work.memory;
    options.threads = work.threads;
    options.backend = flann ? NeighbourBackend::flann : NeighbourBackend::own;
}

Result compute_attributes(const Context& context, const TargetArguments& choice, const Arguments& arguments,
                          NeighbourAttributeOptions options)
{
    options.progress = context.progress;
    options.overwrite = choice.overwrite;
    const TargetChoice place = choice.choice(context.face, arguments);
    NeighbourAttributeReport report =
        context.team ? compute_neighbour_attributes_by(*context.team, choice.tree, place, options)
                     : UpdateTarget(choice.tree, place).update([&](const std::filesystem::path& folder) {
                           return compute_neighbour_attributes(folder, options);
                       });
    note_memory(report, options.memory_bytes);
    Result result;
    const std::string changed = place.in_place ? choice.tree : choice.output;
    choice.describe(result, changed);
    put_attribute_report(result, options.wanted, report);
    if (context.face == Face::dialog) {  // where the picture changes with them
        const Schema schema = Tree::open(changed)->info().schema;
        if (schema.find(attribute_name::radius) && schema.find(attribute_name::normal))
            result.line("the cloud has radii and normals now: Fitted splats, the default, follow them");
    }
    return result;
}

}  // namespace pcm::ops
