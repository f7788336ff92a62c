#include "plugin/scene/sample_region.h"

#include "pcm/cloud/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace pcm::host {

namespace {

constexpr std::size_t most_edges = 60;  // a region has at most 64 planes

// The positions of a sample: those that a region must have, and those that it must not have.
struct Parts {
    std::vector<Vec3d> chosen, others;
};

Parts divide(const Proxy& sample, const std::vector<std::uint32_t>& chosen)
{
    Parts parts;
    std::size_t next = 0;
    for (std::size_t i = 0; i < sample.points.size(); ++i) {
        const auto& p = sample.points[i].position;
        const bool is_chosen = next < chosen.size() && chosen[next] == i;
        next += is_chosen;
        (is_chosen ? parts.chosen : parts.others).push_back({double(p[0]), double(p[1]), double(p[2])});
    }
    return parts;
}

// The face of a convex shape that a point is farthest outside of.
struct Outside {
    std::size_t face = 0;
    double distance = -1;
};

// How far each face may move outwards, at most `most`, until it is halfway to those of the other points that are
// outside of it more than of any other face: they stay outside. None if one of the others is inside.
template <class Find>
std::optional<std::vector<double>> margins(const std::vector<Vec3d>& others, std::size_t faces, double most,
                                           const Find& find)
{
    std::vector<double> nearest(faces, 2 * most);
    for (const Vec3d& p : others) {
        const Outside outside = find(p);
        if (!(outside.distance > 0)) return std::nullopt;
        nearest[outside.face] = std::min(nearest[outside.face], outside.distance);
    }
    for (double& distance : nearest) distance /= 2;
    return nearest;
}

// How far the sample's floats may be from the positions of the cloud.
double rounding_of(const Proxy& sample)
{
    float largest = 0;
    for (const ProxyPoint& point : sample.points)
        for (const float coordinate : point.position) largest = std::max(largest, std::fabs(coordinate));
    return std::ldexp(static_cast<double>(largest), -22);
}

std::string readable(const Vec3d& p)
{
    char text[128];
    std::snprintf(text, sizeof text, "%.3f %.3f %.3f", p[0], p[1], p[2]);
    return text;
}

std::optional<SampleRegion> box_of(const Parts& parts, double spacing, const Vec3d& origin)
{
    Box3d box;
    for (const Vec3d& p : parts.chosen) box.extend(p);
    const auto grown = margins(parts.others, 6, spacing, [&](const Vec3d& p) {
        Outside outside;
        for (std::size_t face = 0; face < 6; ++face) {
            const std::size_t a = face / 2;
            const double distance = face % 2 ? p[a] - box.max[a] : box.min[a] - p[a];
            if (distance > outside.distance) outside = {face, distance};
        }
        return outside;
    });
    if (!grown) return std::nullopt;
    Box3d source;
    for (std::size_t a = 0; a < 3; ++a) {
        source.min[a] = box.min[a] + origin[a] - (*grown)[2 * a];
        source.max[a] = box.max[a] + origin[a] + (*grown)[2 * a + 1];
    }
    return SampleRegion{Region::box(source), "the box " + readable(source.min) + " to " + readable(source.max)};
}

// Clip coordinates of a position: x, y and w.
struct OnScreen {
    std::array<std::array<double, 4>, 3> rows{};  // rows of x (times the aspect), y and w

    OnScreen(const Matrix4d& view, double aspect)
    {
        for (std::size_t c = 0; c < 4; ++c)
            rows[0][c] = aspect * view[4 * c], rows[1][c] = view[4 * c + 1], rows[2][c] = view[4 * c + 3];
    }
    static double at(const std::array<double, 4>& row, const Vec3d& p)
    {
        return row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
    }
    double depth(const Vec3d& p) const { return at(rows[2], p); }
    // In units of half the view's height. Only in front of the eye.
    Vec3d place(const Vec3d& p) const { return {at(rows[0], p) / depth(p), at(rows[1], p) / depth(p), 0}; }
};

double turn(const Vec3d& a, const Vec3d& b, const Vec3d& c)
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// Counter-clockwise, without points on its edges (Andrew's monotone chain).
std::vector<Vec3d> convex_hull(std::vector<Vec3d> points)
{
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return {};
    std::vector<Vec3d> hull;
    for (int half = 0; half < 2; ++half) {
        const std::size_t start = hull.size();
        for (const Vec3d& p : points) {
            while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull.size() < 3 ? std::vector<Vec3d>() : hull;
}

std::vector<Vec3d> rectangle_around(const std::vector<Vec3d>& points)
{
    Box3d box;
    for (const Vec3d& p : points) box.extend(p);
    if (!(box.min[0] < box.max[0] && box.min[1] < box.max[1])) return {};
    return {box.min, {box.max[0], box.min[1], 0}, box.max, {box.min[0], box.max[1], 0}};
}

struct Edge {
    Vec3d normal{};  // outwards, unit
    double offset = 0;
    double distance(const Vec3d& p) const { return normal[0] * p[0] + normal[1] * p[1] - offset; }
};

std::vector<Edge> edges_of(const std::vector<Vec3d>& polygon)
{
    std::vector<Edge> edges;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        Edge edge;
        edge.normal = normalised({b[1] - a[1], a[0] - b[0], 0});
        edge.offset = dot(edge.normal, a);
        edges.push_back(edge);
    }
    return edges;
}

// What the view shows inside of a polygon, at any depth in front of the eye.
std::optional<Region> cone_of(const std::vector<Vec3d>& polygon, const Parts& parts, double spacing,
                              const Vec3d& origin, const OnScreen& screen)
{
    if (polygon.empty() || polygon.size() > most_edges) return std::nullopt;
    const std::vector<Edge> edges = edges_of(polygon);
    double nearest = 0;  // the largest depth of the chosen ones: there the spacing on the screen is smallest
    for (const Vec3d& p : parts.chosen) nearest = std::max(nearest, screen.depth(p));
    const auto& y = screen.rows[1];
    const double most = spacing * length({y[0], y[1], y[2]}) / nearest;
    const auto grown = margins(parts.others, edges.size(), most, [&](const Vec3d& p) {
        Outside outside;
        if (screen.depth(p) <= 0) return Outside{0, 1e300};
        const Vec3d place = screen.place(p);
        for (std::size_t e = 0; e < edges.size(); ++e)
            if (edges[e].distance(place) > outside.distance) outside = {e, edges[e].distance(place)};
        return outside;
    });
    if (!grown) return std::nullopt;
    std::vector<Region::Plane> planes;
    const auto add = [&](const std::array<double, 4>& plane) {
        const double size = length({plane[0], plane[1], plane[2]});
        if (size > 0) planes.push_back({{plane[0] / size, plane[1] / size, plane[2] / size}, plane[3] / size});
    };
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const Edge& edge = edges[e];
        std::array<double, 4> plane{};
        for (std::size_t c = 0; c < 4; ++c)
            plane[c] = (edge.offset + (*grown)[e]) * screen.rows[2][c] - edge.normal[0] * screen.rows[0][c] -
                       edge.normal[1] * screen.rows[1][c];
        add(plane);
    }
    add(screen.rows[2]);
    return Region::convex(origin, planes);
}

bool fits(const Region& region, const Parts& parts, const Vec3d& origin)
{
    const auto inside = [&](const Vec3d& p) { return region.contains(p + origin); };
    return std::all_of(parts.chosen.begin(), parts.chosen.end(), inside) &&
           std::none_of(parts.others.begin(), parts.others.end(), inside);
}

}  // namespace

std::optional<SampleRegion> region_of(const Proxy& sample, const std::vector<std::uint32_t>& chosen,
                                      const Vec3d& origin, const std::optional<Matrix4d>& view, double aspect)
{
    if (chosen.empty()) return std::nullopt;
    const Parts parts = divide(sample, chosen);
    const double reach = std::max(sample.spacing, rounding_of(sample));
    if (auto box = box_of(parts, reach, origin)) return box;
    if (!view) return std::nullopt;
    const OnScreen screen(*view, aspect);
    std::vector<Vec3d> places;
    for (const Vec3d& p : parts.chosen) {
        if (!(screen.depth(p) > 0)) return std::nullopt;
        places.push_back(screen.place(p));
    }
    const auto rectangle = cone_of(rectangle_around(places), parts, reach, origin, screen);
    if (rectangle && fits(*rectangle, parts, origin))
        return SampleRegion{*rectangle, "a rectangle of this view, at any depth"};
    const auto polygon = cone_of(convex_hull(places), parts, reach, origin, screen);
    if (polygon && fits(*polygon, parts, origin)) return SampleRegion{*polygon, "a polygon of this view, at any depth"};
    return std::nullopt;
}

}  // namespace pcm::host
