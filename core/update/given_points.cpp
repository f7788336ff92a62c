#include "pcm/update/given_points.h"

#include "pcm/build/bins/row.h"

#include <utility>
#include <vector>

namespace pcm {
namespace {

bool touch(const Box3i& a, const Box3i& b)
{
    for (std::size_t k = 0; k < 3; ++k)
        if (a.max[k] < b.min[k] || a.min[k] > b.max[k]) return false;
    return true;
}

}  // namespace

template <class Coord>
GivenLevels<Coord> given_levels(std::shared_ptr<const Tree> tree)
{
    GivenLevels<Coord> given;
    given.spacings = tree->info().spacings;
    given.list = [tree = std::move(tree)](const Point<Coord>& low, const Point<Coord>& high, std::size_t first,
                                          std::size_t last, const typename GivenLevels<Coord>::Visit& visit) {
        Box3i box;
        for (std::size_t a = 0; a < 3; ++a) {
            box.min[a] = to_grid<Coord>(low[a]);
            box.max[a] = to_grid<Coord>(high[a]);
        }
        std::vector<NodeId> open;
        if (!tree->nodes().empty()) open.push_back(0);
        std::vector<Point<Coord>> points;
        while (!open.empty()) {
            const NodeId id = open.back();
            open.pop_back();
            const Node& node = tree->node(id);
            // The nodes below hold finer levels only.
            if (!touch(node.box, box) || (node.points && node.first_level > last)) continue;
            for (const NodeId child : node.children)
                if (child != no_node) open.push_back(child);
            if (node.points == 0 || node.first_level + node.level_points.size() <= first) continue;
            const ChunkPart part =
                tree->read_chunk_part(id, ColumnSet::only_positions(), [&](const Box3i& piece, std::uint16_t level) {
                    return level >= first && level <= last && touch(piece, box);
                });
            points.clear();
            for (std::uint32_t i = 0; i < part.chunk.points; ++i) {
                const Vec3i q = part.chunk.positions->grid(i);
                if (!box.contains(q)) continue;
                points.push_back({to_coordinate<Coord>(q[0]), to_coordinate<Coord>(q[1]), to_coordinate<Coord>(q[2])});
            }
            if (!points.empty()) visit(points.data(), points.size());
        }
    };
    return given;
}

template GivenLevels<std::uint32_t> given_levels(std::shared_ptr<const Tree> tree);
template GivenLevels<std::uint64_t> given_levels(std::shared_ptr<const Tree> tree);

}  // namespace pcm
