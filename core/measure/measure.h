// Measures at points of clouds: their numbers, and how uncertain these are.
//
// Positions and results are double, in source units. All is computed from differences of positions, so that map
// coordinates cost no digits. The uncertainty of a number is one standard deviation, propagated to first order from the
// points: each coordinate of a point is uncertain by grid_step / sqrt(12) (rounding to the grid), and the place that a
// user meant by about spacing / 4, since the cloud has no nearer point to pick. Both are independent of each other and
// of the other points'. All functions are for any thread.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/shapes/shape.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Values of each kind, in their order; d is the difference of two points, dz its part along z, "in plan" is without z.
enum class MeasureKind : std::uint8_t {
    point,  // one point: x, y, z
    // A line along two or more points: "distance" along it, "horizontal" the same in plan, "vertical" from the first
    // point to the last (negative: downwards), "slope" = vertical / horizontal in % and in degrees (-90 to 90; no % on
    // a vertical line, neither at one place), and, of more than two points, "direct" from the first to the last.
    distance,
    // Two points: "height", dz from the first to the second (negative: downwards), and "horizontal".
    height,
    // Three points: "angle" at the second one, 0 to 180 degrees, by atan2(|a x b|, a . b), and "plan angle", the same
    // in plan; absent where a leg is vertical.
    angle,
    // A polygon of three or more points. Its vector area is A = 1/2 sum(p[i] x p[i + 1]) (Newell), and its fitted plane
    // the one with the normal n = A / |A| for which the squares of the points' distances to it are least: through their
    // mean. "true area" = |A|, of the polygon seen along n (no direction shows more of it); "plan area" = |A . z|, as
    // seen from above, absent where the polygon crosses itself seen so, and behind the true area where the plane is
    // steeper than 60 degrees, as on facades; "perimeter" along the edges; and, of more than three points, "off plane",
    // the largest distance of a point to the fitted plane.
    area,
    // Four or more points: "distance" of the first one to the plane through the others (least squares of more than
    // three, which then give "residual", the root mean square of theirs), never negative.
    plane,
    volume,   // a polygon: the volume of a cloud against a level or another cloud in it (measure/volume.h); "plan area"
    profile,  // a line of two or more points and a width (measure/profile.h); "length" in plan
    surface,  // one point: its "distance", never negative, to a shape given by numbers (shapes/shape.h)
};
inline constexpr std::size_t measure_kinds = 9;

struct MeasuredPoint {
    Vec3d position{};
    double spacing = 0;    // about the distance to the neighbours in its cloud; 0: not known
    double grid_step = 0;  // the largest step of the cloud's grid; 0: positions are exact
    std::string cloud;     // the tree's folder; empty: typed

    // Variance of each coordinate: what the two above make of it.
    double variance() const { return grid_step * grid_step / 12 + spacing * spacing / 16; }
};

// One number of a measure.
struct MeasureValue {
    std::string name;  // "distance", "horizontal", ...
    double value = 0;
    double uncertainty = 0;  // the same unit
    std::string unit;        // "" (source units), "^2", "^3", "deg", "%"
};

struct Measure {
    MeasureKind kind = MeasureKind::distance;
    std::string name;
    std::vector<MeasuredPoint> points;
    bool hidden = false;           // in views
    double width = 0;              // width of a profile
    std::optional<Shape> surface;  // surface of a distance to a surface
    // Numbers that took a pass over clouds (volume, profile); values_of() gives them back, before all others.
    std::vector<MeasureValue> computed;
};

// Minimum and maximum number of points that the kind takes.
struct PointNumbers {
    std::size_t least, most;
};
PointNumbers point_numbers(MeasureKind kind);
const char* name_of(MeasureKind kind);  // as the enumerators are called
std::optional<MeasureKind> measure_kind(const std::string& name);

// Most important first. Throws Error(invalid_argument) with the reason for a number of points that the kind does not
// take, coordinates that are not finite, and points that determine no answer: an angle at coincident points, a plane
// through collinear ones, a polygon without area or one that crosses itself.
std::vector<MeasureValue> values_of(const Measure& measure);

// "12.345 ± 0.002 m": rounded to the digits that the uncertainty leaves (two where it begins with 1), and to 10 digits
// where that is 0. `unit`: unit of lengths, such as "m"; may be empty.
std::string text_of(const MeasureValue& value, const std::string& unit);
// For labels: the first value as text, of a volume with the part of the area that has points where that is not all of
// it; what is wrong where values_of() throws.
std::string label_of(const Measure& measure, const std::string& unit);

}  // namespace pcm
