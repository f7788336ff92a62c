#include "pcm/shapes/plane_outline.h"

#include "pcm/cloud/exact_products.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/shapes/box_corners.h"
#include "pcm/shapes/concave_outline.h"
#include "pcm/shapes/flat_points.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>

namespace pcm::shapes {
namespace {

// Heights of a box's corners above a plane.
struct CornerHeights {
    std::array<double, 8> h{};
    // The same, less exact, and monotonic along each edge: so the signs are those of some plane, and a cut goes around.
    std::array<double, 8> monotonic{};

    CornerHeights(const Shape& plane, const Box3d& box)
    {
        for (unsigned c = 0; c < 8; ++c) {
            const Vec3d d = corner_of(box, c) - plane.point;
            h[c] = exact_dot(plane.axis, d);
            monotonic[c] = dot(plane.axis, d);
        }
    }
    double lowest() const { return *std::min_element(h.begin(), h.end()); }
    double highest() const { return *std::max_element(h.begin(), h.end()); }
};

// Where the plane crosses the edge from corner a to b, which differ in one coordinate.
Vec3d crossing(const Box3d& box, const CornerHeights& heights, unsigned a, unsigned b)
{
    const Vec3d from = corner_of(box, a), to = corner_of(box, b);
    const double part = heights.h[a] / (heights.h[a] - heights.h[b]);
    return from + std::clamp(std::isfinite(part) ? part : 0.0, 0.0, 1.0) * (to - from);
}

// The crossings in the order in which the cut goes around the box: each face that it crosses has two of them, so it is
// followed from face to face.
std::vector<Vec3d> cut_around(const Box3d& box, const CornerHeights& heights, const std::array<bool, 8>& above)
{
    struct Edge {
        unsigned low, axis;  // from the corner `low` along the axis
        unsigned faces[2];   // 2 axis + side
    };
    std::vector<Edge> edges;
    for (unsigned axis = 0; axis < 3; ++axis)
        for (unsigned c = 0; c < 8; ++c) {
            if ((c >> axis & 1) || above[c] == above[c | 1u << axis]) continue;
            const unsigned one = (axis + 1) % 3, two = (axis + 2) % 3;
            edges.push_back({c, axis, {2 * one + (c >> one & 1), 2 * two + (c >> two & 1)}});
        }
    std::vector<Vec3d> corners;
    if (edges.empty()) return corners;
    for (unsigned face = edges.front().faces[0], next = 0; !edges.empty();) {
        const Edge edge = edges[next];
        edges.erase(edges.begin() + next);
        corners.push_back(crossing(box, heights, edge.low, edge.low | 1u << edge.axis));
        face = edge.faces[0] == face ? edge.faces[1] : edge.faces[0];
        for (next = 0; next < edges.size(); ++next)
            if (edges[next].faces[0] == face || edges[next].faces[1] == face) break;
        if (next == edges.size()) break;
    }
    return corners;
}

// Without corners as near to the one before as rounding brings them.
std::vector<Vec3d> distinct(const std::vector<Vec3d>& corners, double nearness)
{
    std::vector<Vec3d> kept;
    for (const Vec3d& p : corners)
        if (kept.empty() || length(p - kept.back()) > nearness) kept.push_back(p);
    while (kept.size() > 1 && length(kept.front() - kept.back()) <= nearness) kept.pop_back();
    return kept;
}

double signed_area(const Shape& plane, const std::vector<Vec3d>& corners)
{
    double sum = 0;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        sum += dot(plane.axis, cross(corners[i] - corners[0], corners[i + 1] - corners[0]));
    return sum / 2;
}

// Inliers in the plane's own coordinates, about the first of them.
struct PlanePoints {
    PlanePoints(const Shape& plane, const std::vector<Vec3d>& inliers) : frame(plane.axis)
    {
        origin = inliers.front() - exact_dot(plane.axis, inliers.front() - plane.point) * plane.axis;
        flat.reserve(inliers.size());
        for (const Vec3d& p : inliers) flat.push_back({dot(frame.u, p - origin), dot(frame.v, p - origin)});
    }
    Vec3d at(const Vec2d& p) const { return origin + p[0] * frame.u + p[1] * frame.v; }

    AxisFrame frame;
    Vec3d origin{};
    std::vector<Vec2d> flat;
};

void check_extent(const std::vector<Vec2d>& points)
{
    constexpr double largest = 1e150;  // products of such numbers are finite
    for (const Vec2d& p : points)
        if (!(std::fabs(p[0]) < largest && std::fabs(p[1]) < largest))
            throw Error(ErrorCode::invalid_argument, {}, "the plane's points are too far apart to have an outline");
}

double shorter_side(const std::vector<Vec2d>& rectangle)
{
    if (rectangle.size() < 4) return 0;
    const auto side = [&](std::size_t i) {
        return std::hypot(rectangle[i + 1][0] - rectangle[i][0], rectangle[i + 1][1] - rectangle[i][1]);
    };
    return std::min(side(0), side(1));
}

}  // namespace

std::vector<Vec3d> plane_in_box(const Shape& plane, const Box3d& box)
{
    const CornerHeights heights(plane, box);
    const double size = box.diagonal();
    const double largest = std::max(largest_magnitude(box.min), largest_magnitude(box.max));
    const double nearness = 1e-12 * size + 4e-16 * largest;
    std::vector<Vec3d> corners;
    if (heights.highest() - heights.lowest() <= 1e-9 * size && heights.lowest() <= nearness &&
        heights.highest() >= -nearness) {
        // A flat box in the plane.
        std::size_t thin = 0;
        for (std::size_t a = 1; a < 3; ++a)
            if (box.extent(a) < box.extent(thin)) thin = a;
        const unsigned one = 1u << (thin + 1) % 3, two = 1u << (thin + 2) % 3;
        for (const unsigned c : {0u, one, one | two, two})
            corners.push_back(corner_of(box, c) - heights.h[c] * plane.axis);
    } else {
        std::array<bool, 8> above{};
        const auto& h = heights.monotonic;
        // A plane along a face of the box cuts it there, whichever side the box is on.
        const bool along_top = *std::max_element(h.begin(), h.end()) <= 0;
        for (unsigned c = 0; c < 8; ++c) above[c] = along_top ? h[c] >= 0 : h[c] > 0;
        corners = cut_around(box, heights, above);
    }
    corners = distinct(corners, nearness);
    const double area = signed_area(plane, corners);
    if (corners.size() < 3 || !(std::fabs(area) > nearness * size)) return {};
    if (area < 0) std::reverse(corners.begin(), corners.end());
    return corners;
}

std::vector<Vec3d> outline_of_points(const Shape& plane, const std::vector<Vec3d>& inliers,
                                     const OutlineOptions& options)
{
    const PlanePoints in_plane(plane, inliers);
    check_extent(in_plane.flat);
    const FlatPoints points(in_plane.flat);
    std::vector<Vec2d> outline;
    for (const std::uint32_t place : points.convex_hull()) outline.push_back(in_plane.flat[points[place].index]);
    const std::vector<Vec2d> rectangle = least_rectangle(outline);
    const double coordinates = largest_magnitude(in_plane.origin);
    if (outline.size() < 3 || shorter_side(rectangle) <= 4 * points.step() + 1e-15 * coordinates)
        throw Error(ErrorCode::invalid_argument, {},
                    outline.size() < 2 ? "the plane's points are all at one place: they have no outline"
                                       : "the plane's points are all on one line: they have no outline",
                    "bound the plane by a box, or take points from a larger part of it");
    if (options.kind == OutlineKind::rectangle) outline = rectangle;
    if (options.kind == OutlineKind::concave) {
        outline.clear();
        for (const std::uint32_t place : concave_outline(points, options.edge))
            outline.push_back(in_plane.flat[points[place].index]);
    }
    std::vector<Vec3d> corners;
    for (const Vec2d& p : outline) corners.push_back(in_plane.at(p));
    return corners;
}

}  // namespace pcm::shapes
