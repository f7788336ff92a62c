#include "pcm/query/local_spacing.h"

#include "pcm/cloud/vector.h"
#include "pcm/query/nearest.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pcm {
namespace {

constexpr std::size_t asked = 16, neighbours = 4;
constexpr std::size_t read = 64;  // so that the neighbours of those in the middle are there
constexpr std::size_t block_bytes = std::size_t(4) << 20;

}  // namespace

double local_spacing(L2Cache& cache, const Vec3d& place)
{
    BlockCache blocks(block_bytes);
    const std::vector<Neighbour> near = find_nearest(cache, blocks, place, read, {}).points;
    std::vector<double> spacings;
    for (std::size_t i = 0; i < std::min(asked, near.size()); ++i) {
        std::vector<double> away;
        for (const Neighbour& other : near) {
            const double square = squared_distance(near[i].position, other.position);
            if (square > 0) away.push_back(std::sqrt(square));
        }
        if (away.empty()) continue;
        const std::size_t count = std::min(neighbours, away.size());
        std::partial_sort(away.begin(), away.begin() + static_cast<std::ptrdiff_t>(count), away.end());
        double sum = 0;
        for (std::size_t k = 0; k < count; ++k) sum += away[k];
        spacings.push_back(sum / static_cast<double>(count));
    }
    if (spacings.empty()) return 0;
    const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
    std::nth_element(spacings.begin(), middle, spacings.end());
    return *middle;
}

}  // namespace pcm
