#include "pcm/cli/attribute_options.h"

#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree;
    TargetOptions target;
    NeighbourOptions neighbours;
    std::uint32_t radius_neighbours = usual_radius_neighbours;
    double radius_limit = usual_radius_limit;
    bool radii = false, curvature = false, mean_distance = false, confidence = true;
    std::vector<double> viewpoint, direction;
};

int run(const Arguments& arguments)
{
    NeighbourAttributeOptions options;
    options.wanted.normal = true;
    options.wanted.radius = arguments.radii;
    options.wanted.radius_neighbours = arguments.radius_neighbours;
    options.wanted.curvature = arguments.curvature;
    options.wanted.confidence = arguments.confidence;
    options.wanted.mean_distance = arguments.mean_distance;
    if (!arguments.viewpoint.empty()) {
        options.orientation.rule = NormalOrientation::Rule::viewpoint;
        for (std::size_t a = 0; a < 3; ++a) options.orientation.vector[a] = arguments.viewpoint[a];
    } else if (!arguments.direction.empty()) {
        options.orientation.rule = NormalOrientation::Rule::direction;
        for (std::size_t a = 0; a < 3; ++a) options.orientation.vector[a] = arguments.direction[a];
    }
    options.radius_limit = arguments.radius_limit;
    arguments.neighbours.put_into(options);
    return run_attribute_filter(arguments.common, arguments.tree, arguments.target, options);
}

}  // namespace

Run add_normals(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    arguments->target.add_to(options);
    arguments->target.add_overwrite(options, "normal_confidence, curvature and mean_distance");
    options.flag("--radii", arguments->radii, "Also write radii, measured across the normals, in the same pass");
    options
        .option("--radius-neighbours", arguments->radius_neighbours,
                "How many of the nearest neighbours a radius covers (default 6; at most -k)")
        .between(1, 1024);
    options
        .option(
            "--radius-limit", arguments->radius_limit,
            "A radius is at most so many times the size of the point that the tree has for splats, so that discs of "
            "points that stand alone stay small (default 2.5; 0: no limit)")
        .not_negative();
    options.flag("--curvature", arguments->curvature, "Also write the attribute curvature, 0 (plane) to 1/3");
    options.flag("--mean-distance", arguments->mean_distance,
                 "Also write the attribute mean_distance: to the neighbours, source units");
    options.off_flag("--no-confidence", arguments->confidence,
                     "Leave out the attribute normal_confidence (0 good, 1 neighbours on a line, 2 no plane, 3 too few "
                     "neighbours, 4 on two surfaces, as of a thin plate: the side is a guess)");
    const char* const group = "Side that normals point to (default: the same along each surface, outward or up)";
    const auto viewpoint =
        options.option("--viewpoint", arguments->viewpoint, "Towards the scanner's position X Y Z, source coordinates")
            .values(3)
            .group(group);
    options.option("--direction", arguments->direction, "To the half space of a direction X Y Z, such as 0 0 1")
        .values(3)
        .group(group)
        .excludes(viewpoint);
    arguments->neighbours.add_to(options);
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
