// Point Cloud Tree Information: what a tree holds, in the log.
#include "pcm/tree/tree.h"

#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

void log_positions(const FilterRun& run, const TreeInfo& info)
{
    run.log("Points: " + grouped(info.points));
    log_skipped(run, info.points_skipped);
    if (info.points) {
        const Box3d bounds = info.bounds();
        run.log("Bounds, source coordinates: " + exact(bounds.min) + " to " + exact(bounds.max));
    }
    run.log("Scale: " + exact(info.grid.scale));
    run.log("Origin: " + exact(info.grid.offset));
    run.log("Largest position error: " + exact(info.position_error) + " source units; positions in the sources are " +
            std::string(name_of(info.position_type)));
}

void log_attributes(const FilterRun& run, const Schema& schema)
{
    for (const Attribute& attribute : schema) {
        std::string line = "Attribute: " + attribute.name + ", " + std::string(name_of(attribute.type));
        if (attribute.components > 1) line += " x " + std::to_string(attribute.components);
        if (attribute.scale != 1 || attribute.offset != 0)
            line += ", times " + exact(attribute.scale) + " plus " + exact(attribute.offset);
        run.log(line);
    }
}

void log_levels(const FilterRun& run, const Tree& tree)
{
    run.log(std::string("Levels chosen by: ") +
            (tree.info().sampling == Sampling::grid ? "a grid (fast build)" : "Poisson disks"));
    const std::vector<LevelSummary> levels = tree.level_summaries();
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const LevelSummary& level = levels[i];
        run.log("Level " + std::to_string(i) + ": " + grouped(level.points) + " points in " + grouped(level.nodes) +
                (level.nodes == 1 ? " chunk" : " chunks") +
                (level.spacing > 0 ? ", spacing " + brief(level.spacing) : ", complete from here on"));
    }
}

void add_parameters(RichParameterList& parameters) { add_tree_parameter(parameters); }

void run(const FilterRun& run)
{
    const QString given = run.parameters.getString("Tree");
    const std::shared_ptr<const Tree> tree =
        given.trimmed().isEmpty() ? shown_tree(run.document)->tree() : Tree::open(absolute_path(given));
    const TreeInfo& info = tree->info();
    run.log("Tree: " + tree->folder().string());
    for (const std::string& source : info.sources) run.log("Built from: " + source);
    log_positions(run, info);
    log_attributes(run, info.schema);
    if (info.generation > 1)
        run.log("Updates since the build: " + std::to_string(info.generation - 1) +
                "; parts: " + std::to_string(tree->part_roots().size()));
    if (!info.coverage_kept)
        run.log("Coarse levels have gaps where points were deleted. Compact Point Cloud Tree closes them.");
    log_levels(run, *tree);
    const std::string per_point =
        info.points
            ? ", " + brief(static_cast<double>(info.bytes) / static_cast<double>(info.points)) + " bytes per point"
            : std::string();
    run.log("Size: " + bytes_text(info.bytes) + per_point);
}

}  // namespace

Filter tree_information()
{
    return {"Point Cloud Tree Information",
            "Writes the properties of a point cloud tree to the log: number of points, bounds in source coordinates, "
            "attributes, levels of detail with their spacing, size on disk, and the largest position error.",
            MeshFilterInterface::Measure, add_parameters, run};
}

}  // namespace pcm::host
