#include "pcm/pick/pick_cone.h"

namespace pcm {

namespace {

constexpr double spacings_of_radius = 4;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

}  // namespace

PickCone::PickCone(const PickRay& ray, const PickOptions& options, const TreeInfo& info)
    : ray_(ray), options_(options), size_(largest_magnitude(ray.centre) + largest_magnitude(ray.start))
{
    for (std::size_t level = 0; level < info.levels; ++level) {
        const double spacing = level == 0 || level > info.spacings.size() ? 0 : info.spacings[level - 1];
        const bool bounded = spacing > 0 || options.size_scale == 0;
        limits_.push_back(bounded ? spacings_of_radius * spacing * options.size_scale
                                  : std::numeric_limits<double>::infinity());
    }
}

std::optional<double> PickCone::least_depth(const Box3d& box, double radius) const
{
    Vec3d low, high;
    double least = 0, most = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        low[a] = (box.min[a] - ray_.centre[a]) - ray_.start[a];
        high[a] = (box.max[a] - ray_.centre[a]) - ray_.start[a];
        least += std::min(ray_.direction[a] * low[a], ray_.direction[a] * high[a]);
        most += std::max(ray_.direction[a] * low[a], ray_.direction[a] * high[a]);
    }
    // 32: a generous count of the operations from a coordinate to t, s and this bound, each off by half an epsilon.
    const double spare = 32 * epsilon * (size_ + std::max(largest_magnitude(box.min), largest_magnitude(box.max)));
    double begin = std::max(least - spare, ray_.begin), end = std::min(most + spare, ray_.end);
    // A point near the ray at t is in the box, so the ray at t is in the box made larger by what `near` is there. Where
    // the ray leaves that box early, the splats that can reach it are smaller.
    for (int pass = 0; pass < 2 && begin <= end; ++pass) {
        const double around = reach_at(end, radius) * (1 + 4 * epsilon) + spare;
        for (std::size_t a = 0; a < 3; ++a) {
            const double from = low[a] - around, to = high[a] + around, u = ray_.direction[a];
            if (u == 0) {
                if (from > 0 || to < 0) return std::nullopt;
                continue;
            }
            const double one = from / u, other = to / u;
            const double first = std::min(one, other), last = std::max(one, other);
            begin = std::max(begin, first - 8 * epsilon * std::fabs(first));
            end = std::min(end, last + 8 * epsilon * std::fabs(last));
        }
    }
    if (!(begin <= end)) return std::nullopt;
    return begin - spare;
}

}  // namespace pcm
