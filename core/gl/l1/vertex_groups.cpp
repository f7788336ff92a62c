#include "pcm/gl/l1/vertex_groups.h"

#include <algorithm>

namespace pcm {
namespace {

template <class T>
void set_boxes(std::vector<VertexGroup>& groups, const std::array<PageVector<T>, 3>& xyz, const Vec3d& scale)
{
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t g = 0; g < groups.size(); ++g) {
            const std::size_t first = g * VertexGroup::points,
                              end = std::min(first + VertexGroup::points, xyz[a].size());
            T low = xyz[a][first], high = low;
            for (std::size_t i = first; i < end; ++i) {
                low = std::min(low, xyz[a][i]);
                high = std::max(high, xyz[a][i]);
            }
            // Rounded like the vertices; rounding is monotonic, so the box stays tight.
            groups[g].low[a] = static_cast<float>(static_cast<double>(low) * scale[a]);
            groups[g].high[a] = static_cast<float>(static_cast<double>(high) * scale[a]);
        }
}

}  // namespace

std::vector<VertexGroup> make_groups(const ChunkPositions& positions, const Vec3d& scale, const float* radii)
{
    const std::size_t points = positions.size();
    std::vector<VertexGroup> groups((points + VertexGroup::points - 1) / VertexGroup::points);
    positions.wide ? set_boxes(groups, positions.wide_xyz, scale) : set_boxes(groups, positions.narrow_xyz, scale);
    for (std::size_t i = 0; radii && i < points; ++i) {
        float& largest = groups[i / VertexGroup::points].largest_radius;
        largest = std::max(largest, radii[i]);
    }
    return groups;
}

void add_run(std::vector<VertexRun>& runs, std::uint32_t first, std::uint32_t count)
{
    if (!runs.empty() && runs.back().first + runs.back().count == first)
        runs.back().count += count;
    else
        runs.push_back({first, count});
}

}  // namespace pcm
