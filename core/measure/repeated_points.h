// How often a cloud has its points: files that were given twice, overlapping copies. A repeated point is no further
// measurement of its place.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/point_cloud.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// Some hundred points of a stream, evenly: every n-th of them, with n doubled whenever there are too many.
class EvenSample {
public:
    void add(const Vec3d& p);
    const std::vector<Vec3d>& points() const { return points_; }

private:
    std::vector<Vec3d> points_;
    std::uint64_t seen_ = 0, step_ = 1;
};

// Points of the cloud for each place that has one, 1 to 64: with m_i the number of points at the place of a sampled
// point (equal in all bits), the mean of 1 / m_i is the number of places by that of points. 1 for an empty sample. In
// source coordinates, at a level of the cloud, or in all of it. Throws what PointCloud::nearest() throws.
double points_per_place(PointCloud& cloud, const std::vector<Vec3d>& sample,
                        const std::optional<std::uint16_t>& level = {});

}  // namespace pcm
