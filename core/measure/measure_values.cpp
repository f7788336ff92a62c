#include "pcm/measure/measure_values.h"

#include "pcm/cloud/exact_products.h"
#include "pcm/measure/line_length.h"
#include "pcm/measure/refuse.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr double degrees = 180 / pi;

MeasureValue length_value(const char* name, const LineLength& line, const std::vector<MeasuredPoint>& points)
{
    return {name, line.value, propagated(points, line.gradient, line.variance_apart), ""};
}

MeasureValue vertical_value(const char* name, const std::vector<MeasuredPoint>& points)
{
    const MeasuredPoint &first = points.front(), &last = points.back();
    return {name, last.position[2] - first.position[2], std::sqrt(first.variance() + last.variance()), ""};
}

// Uncertainty of vertical / horizontal, by a function f(v, h): its derivatives by v and by h.
double slope_uncertainty(const std::vector<MeasuredPoint>& points, const LineLength& horizontal, double by_v,
                         double by_h)
{
    std::vector<Vec3d> gradient;
    for (const Vec3d& g : horizontal.gradient) gradient.push_back(by_h * g);
    gradient.front()[2] -= by_v;
    gradient.back()[2] += by_v;
    const double apart = horizontal.variance_apart > 0 ? by_h * by_h * horizontal.variance_apart : 0;
    return propagated(points, gradient, apart);
}

void add_slopes(const std::vector<MeasuredPoint>& points, const LineLength& horizontal,
                std::vector<MeasureValue>& values)
{
    const double h = horizontal.value, v = points.back().position[2] - points.front().position[2];
    const double size = std::hypot(h, v);
    if (!(size > 0)) return;
    if (h > 0) {
        const double slope = v / h;
        values.push_back({"slope", 100 * slope, slope_uncertainty(points, horizontal, 100 / h, -100 * slope / h), "%"});
    }
    values.push_back({"slope angle", degrees * std::atan2(v, h),
                      slope_uncertainty(points, horizontal, degrees * (h / size) / size, -degrees * (v / size) / size),
                      "deg"});
}

// With legs a and b from the middle point and the angle t between them: the derivative by the end of a is 1 / |a|
// across it, that by the end of b 1 / |b|, and the cosine between those two directions is -cos(t). So all is defined at
// 0 and 180 degrees too.
struct Leg {
    Vec3d d, lost;  // what rounding took from d matters where the legs are nearly parallel
};

// `v` times the power of two that makes the largest component of `leg` 0.5 to 1: products of legs of any length, also
// of 1e-200, are then neither 0 nor infinite.
Vec3d to_unit(const Vec3d& v, const Vec3d& leg)
{
    int exponent = 0;
    std::frexp(std::max({std::fabs(leg[0]), std::fabs(leg[1]), std::fabs(leg[2])}), &exponent);
    return {std::ldexp(v[0], -exponent), std::ldexp(v[1], -exponent), std::ldexp(v[2], -exponent)};
}

MeasureValue angle_value(const char* name, const std::vector<MeasuredPoint>& points, const Leg& first,
                         const Leg& second)
{
    const Vec3d a = to_unit(first.d, first.d), b = to_unit(second.d, second.d);
    const Vec3d across =
        exact_cross(a, b) + (cross(a, to_unit(second.lost, second.d)) + cross(to_unit(first.lost, first.d), b));
    const double radians = std::atan2(length(across), exact_dot(a, b));
    const auto turned = [](const MeasuredPoint& by, const Leg& leg) {
        return std::sqrt(by.variance()) / length(leg.d);
    };
    const double by_first = turned(points[0], first), by_last = turned(points[2], second);
    const double middle_a = turned(points[1], first), middle_b = turned(points[1], second);
    const double by_middle = middle_a * middle_a + middle_b * middle_b - 2 * middle_a * middle_b * std::cos(radians);
    const double variance = by_first * by_first + by_last * by_last + std::max(by_middle, 0.0);
    return {name, degrees * radians, degrees * std::sqrt(variance), "deg"};
}

}  // namespace

std::vector<MeasureValue> point_values(const Measure& measure)
{
    const MeasuredPoint& point = measure.points[0];
    const double uncertainty = std::sqrt(point.variance());
    return {{"x", point.position[0], uncertainty, ""},
            {"y", point.position[1], uncertainty, ""},
            {"z", point.position[2], uncertainty, ""}};
}

std::vector<MeasureValue> distance_values(const Measure& measure)
{
    const std::vector<MeasuredPoint>& points = measure.points;
    const LineLength horizontal = line_length(points, Seen::in_plan);
    std::vector<MeasureValue> values{length_value("distance", line_length(points, Seen::in_space), points),
                                     length_value("horizontal", horizontal, points),
                                     vertical_value("vertical", points)};
    add_slopes(points, horizontal, values);
    if (points.size() > 2) {
        const std::vector<MeasuredPoint> ends{points.front(), points.back()};
        values.push_back(length_value("direct", line_length(ends, Seen::in_space), ends));
    }
    return values;
}

std::vector<MeasureValue> height_values(const Measure& measure)
{
    return {vertical_value("height", measure.points),
            length_value("horizontal", line_length(measure.points, Seen::in_plan), measure.points)};
}

std::vector<MeasureValue> angle_values(const Measure& measure)
{
    const std::vector<MeasuredPoint>& points = measure.points;
    const auto leg = [&](const MeasuredPoint& end) {
        return Leg{end.position - points[1].position, lost_in_difference(end.position, points[1].position)};
    };
    Leg a = leg(points[0]), b = leg(points[2]);
    if (!(length(a.d) > 0) || !(length(b.d) > 0))
        refuse(std::string("there is no angle: the ") + (length(a.d) > 0 ? "third" : "first") +
               " point is at the place of the second");
    std::vector<MeasureValue> values{angle_value("angle", points, a, b)};
    a.d[2] = b.d[2] = a.lost[2] = b.lost[2] = 0;
    if (length(a.d) > 0 && length(b.d) > 0) values.push_back(angle_value("plan angle", points, a, b));
    return values;
}

std::vector<MeasureValue> surface_values(const Measure& measure)
{
    if (!measure.surface)
        refuse("the measure 'surface' has no surface: a plane, cylinder, sphere, cone or torus is needed");
    check(*measure.surface);
    const MeasuredPoint& point = measure.points[0];
    return {{"distance", distance_to(*measure.surface, point.position), std::sqrt(point.variance()), ""}};
}

std::vector<MeasureValue> profile_values(const Measure& measure)
{
    const LineLength line = line_length(measure.points, Seen::in_plan);
    if (!(line.value > 0)) refuse("the line of the profile has no length in plan");
    return {length_value("length", line, measure.points)};
}

}  // namespace pcm
