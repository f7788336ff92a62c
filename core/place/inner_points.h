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

// Counts points on a shape and off it in cubes. Cubes are doubled where there would be too many. Answers do not depend
// on the order of the points. One object by one thread.
class EdgeCubes {
public:
    // `corner`: below all points; `edge`: edge of the first cubes, > 0; source units. Memory: some 60 bytes per cube.
    EdgeCubes(const Vec3d& corner, double edge, std::size_t most = std::size_t(1) << 18);

    void add(const Vec3d& p, bool on_shape);
    double edge() const { return edge_; }
    // Doubles cubes until there are four points in each on average.
    void widen();
    // Makes is_edge() fast, until more points are added.
    void find_edges();
    // Whether the place's cube and those around it have more than a tenth as many points off the shape as on it, and at
    // least two off it.
    bool is_edge(const Vec3d& p) const;

private:
    using Key = std::array<std::int32_t, 3>;
    struct Hash {
        std::size_t operator()(const Key& key) const;
    };
    struct Counts {
        std::uint64_t on = 0, off = 0;
        bool is_edge = false;  // where edges are found
    };
    Key key_of(const Vec3d& p) const;
    void coarsen();
    bool is_edge_cube(const Key& key) const;

    const Vec3d corner_;
    double edge_;
    const std::size_t most_;
    std::uint64_t points_ = 0;
    bool are_edges_found_ = false;
    std::unordered_map<Key, Counts, Hash> cubes_;
};

// The points of the set at places for which `wanted` holds, which several threads may ask. Streams. Throws
// Error(cancelled), and what reading throws.
PointSet points_where(const PointSet& points, const std::function<bool(const Vec3d&)>& wanted, unsigned threads = 0,
                      const ProgressFunction& progress = {});

// The points of the set that are not at an edge: not next to points of `around` that are farther than the threshold
// from the shape (EdgeCubes, two thresholds wide at first). Streams. Throws Error(cancelled), and what reading throws.
PointSet inner_points(const PointSet& points, const PointSet& around, const Shape& shape, double threshold,
                      unsigned threads = 0, const ProgressFunction& progress = {});

}  // namespace pcm
