#include "plugin/filter/tree_information.h"

#include "plugin/host/text.h"

namespace pcm::host {

std::vector<std::string> tree_information(const Tree& tree)
{
    const TreeInfo& info = tree.info();
    std::vector<std::string> lines;
    lines.push_back("Tree: " + tree.folder().string());
    for (const std::string& source : info.sources) lines.push_back("Built of: " + source);
    lines.push_back("Points: " + grouped(info.points));
    if (info.points_skipped)
        lines.push_back("Left out: " + grouped(info.points_skipped) + " points without a finite position");
    if (info.points) {
        const Box3d bounds = info.bounds();
        lines.push_back("Bounds, source coordinates: " + exact(bounds.min) + " to " + exact(bounds.max));
    }
    lines.push_back("Scale: " + exact(info.grid.scale));
    lines.push_back("Origin: " + exact(info.grid.offset));
    lines.push_back("Largest position error: " + exact(info.position_error) + " source units, of " +
                    std::string(name_of(info.position_type)) + " positions");
    for (const Attribute& attribute : info.schema) {
        std::string line = "Attribute: " + attribute.name + ", " + std::string(name_of(attribute.type));
        if (attribute.components > 1) line += " x " + std::to_string(attribute.components);
        if (attribute.scale != 1 || attribute.offset != 0)
            line += ", times " + exact(attribute.scale) + " plus " + exact(attribute.offset);
        lines.push_back(line);
    }

    if (info.generation > 1)
        lines.push_back("Updates since the build: " + std::to_string(info.generation - 1) +
                        "; parts: " + std::to_string(tree.part_roots().size()));
    if (!info.coverage_kept)
        lines.emplace_back("Coarse levels have gaps where points were deleted; Compact Point Cloud Tree closes them.");
    lines.push_back(std::string("Levels chosen by: ") +
                    (info.sampling == Sampling::grid ? "a grid (fast build)" : "Poisson disks"));
    const std::vector<LevelSummary> levels = tree.level_summaries();
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const LevelSummary& level = levels[i];
        std::string line = "Level " + std::to_string(i) + ": " + grouped(level.points) + " points in " +
                           grouped(level.nodes) + (level.nodes == 1 ? " chunk" : " chunks");
        line += level.spacing > 0 ? ", spacing " + brief(level.spacing) : ", nothing is missing from here on";
        lines.push_back(line);
    }
    lines.push_back("Size: " + bytes_text(info.bytes) +
                    (info.points ? ", " + brief(static_cast<double>(info.bytes) / static_cast<double>(info.points)) +
                                       " bytes a point"
                                 : std::string()));
    return lines;
}

}  // namespace pcm::host
