// The numbers of polygons and planes.
#include "pcm/cloud/exact_products.h"
#include "pcm/measure/best_plane.h"
#include "pcm/measure/line_length.h"
#include "pcm/measure/measure_values.h"
#include "pcm/measure/polygon.h"
#include "pcm/measure/refuse.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

// How far a coordinate of the points may be from where it was meant, for its rounding to double.
double rounding_of(const std::vector<MeasuredPoint>& points)
{
    double largest = 0;
    for (const MeasuredPoint& point : points) largest = std::max(largest, largest_magnitude(point.position));
    return eps * largest;
}

std::vector<Vec3d> positions_of(const std::vector<MeasuredPoint>& points)
{
    std::vector<Vec3d> positions;
    for (const MeasuredPoint& point : points) positions.push_back(point.position);
    return positions;
}

// The area's derivative by point i is n x (p[i + 1] - p[i - 1]) / 2, with the unit normal n of the plane that it is
// seen on.
double area_uncertainty(const std::vector<MeasuredPoint>& points, const Vec3d& normal)
{
    std::vector<Vec3d> gradient;
    const std::size_t count = points.size();
    for (std::size_t i = 0; i < count; ++i)
        gradient.push_back(0.5 *
                           cross(normal, points[(i + 1) % count].position - points[(i + count - 1) % count].position));
    return propagated(points, gradient);
}

// Numbers of points as a person counts them; crossings are found in a polygon without the points that repeat.
[[noreturn]] void refuse_crossing()
{
    refuse(
        "the polygon crosses or touches itself: its area is not defined; place the points along its edge, one after "
        "the other");
}

MeasureValue plan_area_value(const std::vector<MeasuredPoint>& points, const Vec3d& area)
{
    return {"plan area", std::fabs(area[2]), area_uncertainty(points, {0, 0, 1}), "^2"};
}

bool crosses_in_plan(const std::vector<Vec3d>& polygon)
{
    std::vector<Vec3d> flat = polygon;
    for (Vec3d& p : flat) p[2] = 0;
    flat = without_repeats(flat);
    return flat.size() < 3 || find_crossing(in_plan(flat)).has_value();
}

// Cosine of the slope from which a polygon is more of a wall than of ground: 60 degrees. The first value is what lists
// show.
constexpr double steep = 0.5;

double off_plane(const std::vector<Vec3d>& polygon, const Vec3d& normal)
{
    Vec3d mean{};
    for (const Vec3d& p : polygon) mean = mean + (p - polygon[0]);
    mean = mean / static_cast<double>(polygon.size());
    double largest = 0;
    for (const Vec3d& p : polygon) largest = std::max(largest, std::fabs(exact_dot(normal, (p - polygon[0]) - mean)));
    return largest;
}

}  // namespace

std::vector<MeasureValue> area_values(const Measure& measure)
{
    const std::vector<MeasuredPoint>& points = measure.points;
    const std::vector<Vec3d> all = positions_of(points), polygon = without_repeats(all);
    const LineLength edge = line_length(points, Seen::in_space, true);
    const Vec3d area = vector_area(all);
    const double size = length(area);
    if (!(size > 4 * rounding_of(points) * edge.value))
        refuse("the polygon has no area: its points lie on a line, or it crosses itself");
    const Vec3d normal = area / size;
    if (find_crossing(seen_along(polygon, normal))) refuse_crossing();
    std::vector<MeasureValue> values;
    if (!crosses_in_plan(polygon)) values.push_back(plan_area_value(points, area));
    const MeasureValue true_area{"true area", size, area_uncertainty(points, normal), "^2"};
    values.insert(std::fabs(normal[2]) < steep ? values.begin() : values.end(), true_area);
    values.push_back({"perimeter", edge.value, propagated(points, edge.gradient, edge.variance_apart), ""});
    if (polygon.size() > 3) values.push_back({"off plane", off_plane(polygon, normal), 0, ""});
    return values;
}

std::vector<MeasureValue> volume_values(const Measure& measure)
{
    const std::vector<Vec3d> polygon = positions_of(measure.points);
    const Vec3d area = vector_area(polygon);
    const LineLength edge = line_length(measure.points, Seen::in_plan, true);
    if (!(std::fabs(area[2]) > 4 * rounding_of(measure.points) * edge.value))
        refuse("the polygon has no area in plan: its points lie on a line seen from above, or it crosses itself");
    if (crosses_in_plan(polygon)) refuse_crossing();
    return {plan_area_value(measure.points, area)};
}

std::vector<MeasureValue> plane_values(const Measure& measure)
{
    const std::vector<MeasuredPoint>& points = measure.points;
    const Vec3d origin = points[1].position;
    std::vector<Vec3d> others;
    for (std::size_t i = 1; i < points.size(); ++i) others.push_back(points[i].position - origin);
    const BestPlane plane = best_plane(others);
    const double count = static_cast<double>(others.size());
    if (!(plane.extent[1] > 4 * std::sqrt(count) * rounding_of(points)) ||
        !(plane.extent[1] > 16 * eps * plane.extent[0]))
        refuse("there is no plane: the points that it is to pass through lie on a line");
    Vec3d normal = plane.axes[2];
    if (others.size() == 3) normal = normalised(exact_cross(others[1] - others[0], others[2] - others[0]));
    const Vec3d d = (points[0].position - origin) - plane.centre;
    // How much the plane below the point moves with each point: its weight in the least squares.
    const double u = dot(plane.axes[0], d) / plane.extent[0], v = dot(plane.axes[1], d) / plane.extent[1];
    double variance = points[0].variance(), squares = 0;
    for (std::size_t i = 0; i < others.size(); ++i) {
        const Vec3d e = others[i] - plane.centre;
        const double weight =
            1 / count + u * dot(plane.axes[0], e) / plane.extent[0] + v * dot(plane.axes[1], e) / plane.extent[1];
        variance += points[i + 1].variance() * weight * weight;
        squares += dot(normal, e) * dot(normal, e);
    }
    const double distance = others.size() == 3 ? exact_dot(normal, points[0].position - origin) : exact_dot(normal, d);
    std::vector<MeasureValue> values{{"distance", std::fabs(distance), std::sqrt(variance), ""}};
    if (others.size() > 3) values.push_back({"residual", std::sqrt(squares / count), 0, ""});
    return values;
}

}  // namespace pcm
