#include "pcm/measure/measure.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/measure/measure_values.h"
#include "pcm/system/error.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace pcm {
namespace {

constexpr std::size_t any = std::numeric_limits<std::size_t>::max();

struct Kind {
    const char* name;
    PointNumbers points;
    std::vector<MeasureValue> (*values)(const Measure& measure);
};

// In the order of the enumerators.
const std::array<Kind, measure_kinds> kinds{{{"point", {1, 1}, point_values},
                                             {"distance", {2, any}, distance_values},
                                             {"height", {2, 2}, height_values},
                                             {"angle", {3, 3}, angle_values},
                                             {"area", {3, any}, area_values},
                                             {"plane", {4, any}, plane_values},
                                             {"volume", {3, any}, volume_values},
                                             {"profile", {2, any}, profile_values},
                                             {"surface", {1, 1}, surface_values}}};

const Kind& row_of(MeasureKind kind) { return kinds[static_cast<std::size_t>(kind)]; }

void check_points(const Measure& measure)
{
    const Kind& kind = row_of(measure.kind);
    const std::size_t given = measure.points.size();
    if (given < kind.points.least || given > kind.points.most) {
        std::string expected = std::to_string(kind.points.least);
        if (kind.points.most == any) expected += " or more";
        throw Error(ErrorCode::invalid_argument, {},
                    std::string("the measure '") + kind.name + "' takes " + expected +
                        (kind.points.most == 1 ? " point, " : " points, ") + "not " + std::to_string(given));
    }
    for (std::size_t i = 0; i < given; ++i) {
        const std::string point = "point " + std::to_string(i + 1) + " of the measure '" + kind.name + "'";
        require_place(point + ",", measure.points[i].position);
        if (!std::isfinite(measure.points[i].variance()))
            throw Error(ErrorCode::invalid_argument, {}, point + " has an uncertainty that is not finite");
    }
}

// The place of the last digit that the uncertainty leaves: -3 for 0.002 and 0.0015.
int last_place(double uncertainty)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.1e", uncertainty);
    const int exponent = std::atoi(text + 4);
    return text[0] == '1' ? exponent - 1 : exponent;
}

std::string rounded(double value, int place)
{
    char text[400];
    if (place > 0) value = std::round(value / std::pow(10.0, place)) * std::pow(10.0, place);
    std::snprintf(text, sizeof text, "%.*f", place < 0 ? -place : 0, value);
    return text;
}

std::string unit_text(const std::string& unit, const std::string& length_unit)
{
    if (unit == "deg") return "°";
    if (unit == "%") return " %";
    if (length_unit.empty()) return "";
    if (unit == "^2") return " " + length_unit + "²";
    if (unit == "^3") return " " + length_unit + "³";
    return " " + (unit.empty() ? length_unit : unit);
}

}  // namespace

PointNumbers point_numbers(MeasureKind kind) { return row_of(kind).points; }
const char* name_of(MeasureKind kind) { return row_of(kind).name; }

std::optional<MeasureKind> measure_kind(const std::string& name)
{
    for (std::size_t k = 0; k < kinds.size(); ++k)
        if (name == kinds[k].name) return static_cast<MeasureKind>(k);
    return {};
}

std::vector<MeasureValue> values_of(const Measure& measure)
{
    check_points(measure);
    std::vector<MeasureValue> values = measure.computed;
    const std::vector<MeasureValue> own = row_of(measure.kind).values(measure);
    values.insert(values.end(), own.begin(), own.end());
    return values;
}

std::string text_of(const MeasureValue& value, const std::string& unit)
{
    const std::string suffix = unit_text(value.unit, unit);
    if (!(value.uncertainty > 0) || !std::isfinite(value.uncertainty)) {
        char text[64];
        std::snprintf(text, sizeof text, "%.10g", value.value);
        return text + suffix;
    }
    const int place = last_place(value.uncertainty);
    return rounded(value.value, place) + " ± " + rounded(value.uncertainty, place) + suffix;
}

std::string label_of(const Measure& measure, const std::string& unit)
{
    try {
        const std::vector<MeasureValue> values = values_of(measure);
        std::string label = text_of(values.at(0), unit);
        // Adds how much of a volume is measured if it is not all.
        for (const MeasureValue& value : values)
            if (value.name == "area with points" && value.value < 99.95)
                label += ", " + rounded(value.value, value.value < 1 ? -1 : 0) + " % of the area has points";
        return label;
    } catch (const Error& error) {
        return error.what();
    }
}

}  // namespace pcm
