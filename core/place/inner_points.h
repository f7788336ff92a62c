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
    // Share of the points on the shape above which points off it are an edge's: a tenth, and in doubled cubes half of
    // it each time, since the strip of points off it next to an edge is as narrow there.
    double share_of_edges() const;
    // Makes is_edge() fast, until more points are added. `most`: another share.
    void find_edges(double most);
    // Whether the place's cube and those around it have at least two points off the shape, and more than that share of
    // those on it; before find_edges() a tenth.
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
    const double first_edge_;
    double edge_;
    const std::size_t most_;
    std::uint64_t points_ = 0;
    bool are_edges_found_ = false;
    double most_share_;
    std::unordered_map<Key, Counts, Hash> cubes_;
};

// The points of the set at places for which `wanted` holds, which several threads may ask. Streams. Throws
// Error(cancelled), and what reading throws.
PointSet points_where(const PointSet& points, const std::function<bool(const Vec3d&)>& wanted, unsigned threads = 0,
                      const ProgressFunction& progress = {});

// The points of the set that are not at an edge: not next to points of `around` that are farther than the threshold
// from the shape (EdgeCubes, two thresholds wide at first, with their share_of_edges(), or where that leaves less than
// place.growth.min_inner with a tenth). Streams. Throws Error(cancelled), and what reading throws.
PointSet inner_points(const PointSet& points, const PointSet& around, const Shape& shape, double threshold,
                      unsigned threads = 0, const ProgressFunction& progress = {});

}  // namespace pcm
