// Points of a shape away from where the cloud leaves it.
#pragma once

#include "pcm/query/point_set.h"
#include "pcm/shapes/shape.h"
#include "pcm/system/progress.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>

namespace pcm {

// Counts points on and beside a shape in cubes. Cubes are doubled where there would be too many. What it answers does
// not depend on the order of the points. One object by one thread.
class EdgeCubes {
public:
    // `corner` is below all points, `edge` > 0 of the first cubes, source units. Memory: some 60 bytes per cube.
    EdgeCubes(const Vec3d& corner, double edge, std::size_t most = std::size_t(1) << 18);

    void add(const Vec3d& p, bool on_shape);
    double edge() const { return edge_; }
    // Doubles cubes until there are four points in each on average.
    void widen();
    // Whether more than a tenth as many points are beside the shape as on it, and at least two, in the place's cube
    // and those around it.
    bool is_edge(const Vec3d& p) const;

private:
    using Key = std::array<std::int32_t, 3>;
    struct Hash {
        std::size_t operator()(const Key& key) const;
    };
    struct Counts {
        std::uint64_t on = 0, beside = 0;
    };
    Key key_of(const Vec3d& p) const;
    void coarsen();

    const Vec3d corner_;
    double edge_;
    const std::size_t most_;
    std::uint64_t points_ = 0;
    std::unordered_map<Key, Counts, Hash> cubes_;
};

// The points of the set at places for which `wanted` holds, which several threads may ask. Streams. Throws
// Error(cancelled), and what reading throws.
PointSet points_where(const PointSet& points, const std::function<bool(const Vec3d&)>& wanted, unsigned threads = 0,
                      const ProgressFunction& progress = {});

// The points of the set that are not beside points of `around` which are farther than the threshold from the shape
// (EdgeCubes, two thresholds wide at first). Streams. Throws Error(cancelled), and what reading throws.
PointSet inner_points(const PointSet& points, const PointSet& around, const Shape& shape, double threshold,
                      unsigned threads = 0, const ProgressFunction& progress = {});

}  // namespace pcm
