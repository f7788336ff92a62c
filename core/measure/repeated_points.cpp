#include "pcm/measure/repeated_points.h"

namespace pcm {
namespace {

constexpr std::size_t most_sampled = 256, most_repeats = 64;

}  // namespace

void EvenSample::add(const Vec3d& p)
{
    if (seen_++ % step_ != 0) return;
    points_.push_back(p);
    if (points_.size() < most_sampled) return;
    for (std::size_t i = 0; 2 * i < points_.size(); ++i) points_[i] = points_[2 * i];
    points_.resize(points_.size() / 2);
    step_ *= 2;
}

double points_per_place(PointCloud& cloud, const std::vector<Vec3d>& sample, const std::optional<std::uint16_t>& level)
{
    if (sample.empty()) return 1;
    NearestOptions same;
    same.level = level;
    same.max_distance = 0;
    const NearestBatch found = cloud.nearest(sample, most_repeats, same);
    double places = 0;
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const std::size_t count = found.first[i + 1] - found.first[i];
        places += count > 0 ? 1 / static_cast<double>(count) : 1;
    }
    return static_cast<double>(sample.size()) / places;
}

}  // namespace pcm
