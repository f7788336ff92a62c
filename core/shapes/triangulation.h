// The Delaunay triangulation of points of a plane.
#pragma once

#include "pcm/shapes/flat_points.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// By divide and conquer on quad-edges (Guibas and Stolfi 1985), with exact predicates: any points are well
// triangulated, grids and points on one circle too. O(n log n) time, about 75 bytes per point. Immutable.
//
// An edge is a number; its opposite direction is another. Vertices are places in the FlatPoints, which must outlive it.
class Triangulation {
public:
    using Edge = std::uint32_t;

    explicit Triangulation(const FlatPoints& points);

    // All directed edges, for i < edges().
    std::size_t edges() const { return origin_.size(); }
    Edge edge(std::size_t i) const { return static_cast<Edge>(2 * i); }

    std::uint32_t origin(Edge e) const { return origin_[e >> 1]; }
    std::uint32_t target(Edge e) const { return origin(opposite(e)); }
    static Edge opposite(Edge e) { return e ^ 2u; }
    // Of the face to the left, counter-clockwise.
    Edge around_left(Edge e) const { return turned(next_[turned_back(e)]); }

    // Counter-clockwise: all triangles are to the left.
    std::vector<Edge> hull() const;

private:
    struct Ends {
        Edge left, right;  // counter-clockwise out of the leftmost point, clockwise out of the rightmost
    };
    static Edge turned(Edge e) { return (e & ~3u) | ((e + 1) & 3u); }
    static Edge turned_back(Edge e) { return (e & ~3u) | ((e + 3) & 3u); }
    Edge before_at_origin(Edge e) const { return turned(next_[turned(e)]); }
    Edge make_edge(std::uint32_t from, std::uint32_t to);
    void splice(Edge a, Edge b);
    Edge connect(Edge a, Edge b);
    void remove(Edge e);
    std::int64_t turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
    bool is_left_of(std::uint32_t p, Edge e) const { return turn(p, origin(e), target(e)) > 0; }
    bool is_right_of(std::uint32_t p, Edge e) const { return turn(p, target(e), origin(e)) > 0; }
    bool in_circle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const;
    Ends triangulate(std::uint32_t first, std::uint32_t last);
    Ends triangulate_few(std::uint32_t first, std::uint32_t last);
    Edge lower_tangent(Ends& low, Ends& high);
    void merge(Edge base);
    Edge left_candidate(Edge base);
    Edge right_candidate(Edge base);

    const FlatPoints& points_;
    std::vector<Edge> next_;             // of each directed edge and its dual ones
    std::vector<std::uint32_t> origin_;  // of each directed edge
    std::vector<Edge> free_;
    Edge on_hull_ = 0;
};

}  // namespace pcm
