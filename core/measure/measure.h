// Measures at points of clouds: their numbers, and how uncertain these are.
//
// Positions and results are double, in source units, relative to the measure's first point while they are computed, so
// that map coordinates cost no digits. The uncertainty of a number is one standard deviation, propagated to first order
// from the points: each coordinate of a point is uncertain by grid_step / sqrt(12) (rounding to the grid), and the
// place that a user meant by about spacing / 4, since the cloud has no nearer point to pick.
#pragma once

#include "pcm/cloud/geometry.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

enum class MeasureKind : std::uint8_t {
    point,     // one point: its coordinates
    distance,  // a line along two or more points: total, horizontal, vertical, slope, direct
    height,    // two points: the difference along z
    angle,     // three points: the angle at the second one
    area,      // a polygon of three or more points: in plan, on its fitted plane, perimeter
    plane,     // four or more points: the distance of the first one to the plane through the others
    volume,    // a polygon: the volume of a cloud against a level or another cloud in it (measure/volume.h)
    profile,   // a line of two points and a width (measure/profile.h)
};

struct MeasuredPoint {
    Vec3d position{};
    double spacing = 0;    // about the distance to the neighbours in its cloud; 0: not known
    double grid_step = 0;  // the largest step of the cloud's grid; 0: positions are exact
    std::string cloud;     // the tree's folder; empty: typed
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
    bool hidden = false;  // in views
    double width = 0;     // of a profile
    // Numbers that took a pass over clouds (volume, profile); values_of() gives them back.
    std::vector<MeasureValue> computed;
};

// The least and the largest number of points that the kind takes.
struct PointNumbers {
    std::size_t least, most;
};
PointNumbers point_numbers(MeasureKind kind);
const char* name_of(MeasureKind kind);

// Most important first. Throws Error(invalid_argument), saying why, for too few points, coordinates that are not
// finite, and points that determine no answer: an angle at coincident points, a plane through collinear ones, a polygon
// that crosses itself.
std::vector<MeasureValue> values_of(const Measure& measure);

// For labels: the first value with its uncertainty and unit, rounded to the digits that the uncertainty leaves:
// "12.345 ± 0.002 m". `unit`: of lengths, such as "m"; may be empty.
std::string label_of(const Measure& measure, const std::string& unit);

}  // namespace pcm
