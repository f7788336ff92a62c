#include "pcm/place/station_reach.h"

#include "pcm/place/tuning.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>

namespace pcm {

double station_reach(const Tree& tree, const PointStations& stations)
{
    struct Seen {
        double points = 0, squares = 0;  // squares of the distances from the origin
        Vec3d sum{};
    };
    std::map<std::uint32_t, Seen> seen;
    const SourceRounding rounding(tree.info());
    const Vec3d origin = tree.info().bounds().centre();  // near the points, for the differences of squares
    ColumnSet columns = stations.columns();
    columns.positions = true;
    std::size_t parts = 0;
    for (const NodeId root : tree.part_roots()) {
        if (root == no_node || parts++ >= place_tuning().stations.max_parts) continue;
        const Chunk chunk = tree.read_chunk(root, columns);
        for (std::uint32_t i = 0; i < chunk.points; ++i) {
            const Vec3d p = rounding(tree.info().grid.to_source(chunk.positions->grid(i))) - origin;
            Seen& own = seen[stations.at(chunk, i)];
            own.points += 1;
            own.squares += dot(p, p);
            own.sum = own.sum + p;
        }
    }
    double points = 0, squares = 0;
    for (const auto& [station, own] : seen) {
        points += own.points;
        squares += std::max(0.0, own.squares - dot(own.sum, own.sum) / own.points);
    }
    return points > 0 ? std::sqrt(3 * squares / points) : 0;
}

}  // namespace pcm
