#include "pcm/update/inferred_info.h"

#include "pcm/build/bins/row.h"
#include "pcm/build/levels/lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

bool is_power_of_two(double step)
{
    int exponent = 0;
    return std::frexp(step, &exponent) == 0.5;
}

// Whether a build made the grid for floats; it makes no such grid for integers.
bool made_for_floats(const Grid& grid)
{
    bool made = true;
    for (std::size_t a = 0; a < 3; ++a)
        made = made && is_power_of_two(grid.scale[a]) && grid.offset[a] == 0 && grid.scale[a] < 0x1p-30;
    return made;
}

// The spacing of level 0. An inner node has the spacing of its last level, and each level has half the spacing of the
// one before. A level without points in the node is not counted, which makes the result smaller.
double first_spacing(const Grid& grid, const std::vector<PartNode>& nodes)
{
    double spacing = 0;
    Box3i box;
    for (const PartNode& node : nodes) {
        if (node.points == 0) continue;
        box.extend(node.box);
        if (node.spacing > 0)
            spacing = std::max(
                spacing, std::ldexp(node.spacing, static_cast<int>(node.first_level + node.level_points.size()) - 1));
    }
    if (spacing > 0 || box.empty()) return spacing;
    // A single node has no spacing, but that of level 0 is never larger than this.
    Point<std::uint64_t> low, high;
    for (std::size_t a = 0; a < 3; ++a) {
        low[a] = to_coordinate<std::uint64_t>(box.min[a]);
        high[a] = to_coordinate<std::uint64_t>(box.max[a]);
    }
    const Lattice lattice(grid);
    return lattice.spacing(std::min(62, lattice.size_of_box<std::uint64_t>(low, high)));
}

}  // namespace

TreeInfo infer_info(const ChunkKind& kind, const std::vector<PartNode>& nodes)
{
    TreeInfo info;
    info.grid = kind.grid;
    info.schema = kind.schema;
    std::size_t levels = 0;
    for (const PartNode& node : nodes) {
        levels = std::max(levels, node.first_level + node.level_points.size());
        for (std::size_t a = 0; a < 3 && node.points; ++a)
            info.wide = info.wide || node.box.min[a] < std::numeric_limits<std::int32_t>::min() ||
                        node.box.max[a] > std::numeric_limits<std::int32_t>::max();
    }
    const bool floats = made_for_floats(kind.grid);
    info.wide = info.wide || floats;
    info.position_type = floats ? ScalarType::f64 : ScalarType::i32;
    info.sampling = Sampling::grid;  // the weaker guarantee
    info.levels = static_cast<std::uint16_t>(levels);
    double spacing = first_spacing(kind.grid, nodes);
    for (std::size_t level = 0; level < levels; ++level, spacing /= 2)
        info.spacings.push_back(level + 1 == levels ? 0 : spacing);
    return info;
}

}  // namespace pcm
