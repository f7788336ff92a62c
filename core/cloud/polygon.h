// A polygon in the plane, and which points it contains.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

using Vec2d = std::array<double, 2>;

// Closed: an edge joins the last corner to the first. It may be concave, cross itself, and repeat corners.
//
// Even-odd rule: a point is inside when a line from it towards +x crosses an odd number of edges, of which each has its
// lower end and not its upper one. So a part that the border goes around twice is outside. A point on the border is
// inside on left and lower borders, and outside on right and upper ones: of two polygons with a common edge it is in
// one. Deterministic; a point nearer to the border than about 8 eps times the polygon's size (eps = 2^-53) may be
// classified as being on its other side.
//
// Immutable; any number of threads. Memory: about 100 bytes per corner.
class Polygon {
public:
    // At least 3 corners, each coordinate finite and below 1e150 (largest()).
    explicit Polygon(std::vector<Vec2d> corners);

    bool contains(double x, double y) const;
    // Whether an edge comes within `margin` of the convex hull of the points. Conservative: when false, none does, and
    // the hull is wholly inside or wholly outside.
    bool border_touches(const std::vector<Vec2d>& points, double margin) const;

    const std::vector<Vec2d>& corners() const { return corners_; }
    // The smallest rectangle around the corners.
    const Vec2d& min() const { return min_; }
    const Vec2d& max() const { return max_; }

    static constexpr double largest() { return 1e150; }

private:
    struct Edge {
        Vec2d low, high;  // low[1] <= high[1]
    };
    std::size_t band_of(double y) const;
    std::size_t choose_bands(std::size_t bands);

    std::vector<Vec2d> corners_;
    std::vector<Edge> edges_;
    Vec2d min_{}, max_{};
    // Edges by bands of y: those of band b are in_bands_[first_[b]] to in_bands_[first_[b + 1]].
    double bands_per_length_ = 0;
    std::size_t bands_ = 1;
    std::vector<std::size_t> first_;
    std::vector<std::uint32_t> in_bands_;
};

}  // namespace pcm
