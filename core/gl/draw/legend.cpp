#include "pcm/gl/draw/legend.h"

#include "pcm/cloud/las_class.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pcm {
namespace {

// Of an attribute by its usual name; empty for numbers without a unit, and where it is not known.
std::string attribute_unit(const std::string& name)
{
    if (name == "gps_time") return "s";
    if (name == "scan_angle" || name == "scan_angle_rank") return "degrees";
    return {};
}

std::string with_unit(const std::string& name, const std::string& unit)
{
    return unit.empty() ? name : name + " (" + unit + ")";
}

std::string title_of(const CloudReport& report, const std::string& height_unit)
{
    switch (report.style.colour) {
        case ColourMode::height:
        case ColourMode::height_intensity:
            return with_unit("Height", height_unit);
        case ColourMode::attribute:
            return with_unit(report.style.attribute, attribute_unit(report.style.attribute));
        default:
            return traits_of(report.style.colour).label;
    }
}

std::vector<Legend::Row> rows_of(const ClassSet& classes, const std::set<unsigned>& hidden)
{
    std::vector<Legend::Row> rows;
    for (unsigned number = 0; number < 256; ++number)
        if (classes[number] || hidden.count(number))
            rows.push_back({number, class_colour(number), std::to_string(number) + "  " + las_class_name(number),
                            hidden.count(number) != 0});
    return rows;
}

}  // namespace

std::vector<std::string> Legend::lines() const
{
    std::vector<std::string> list{title};
    if (!low.empty()) list.insert(list.end(), {low, middle, high});
    for (const Row& row : rows) list.push_back(row.name + (row.hidden ? " (hidden)" : ""));
    return list;
}

std::optional<Legend> legend_of(const CloudReport& report, const std::string& height_unit,
                                const std::set<unsigned>& hidden)
{
    Legend legend;
    if (report.style.colour == ColourMode::classification) {
        legend.rows = rows_of(report.classes, hidden);
        if (legend.rows.empty()) return std::nullopt;
    } else if (report.range && has_range(report.style.colour)) {
        const ValueRange& range = *report.range;
        const double width = range.high - range.low;
        legend.ramp = ramp_of(report.style);
        legend.range = range;
        legend.low = value_text(range.low, width);
        legend.middle = value_text(range.value_at(0.5), width);
        legend.high = value_text(range.high, width);
    } else {
        return std::nullopt;
    }
    legend.title = title_of(report, height_unit);
    return legend;
}

std::string value_text(double value, double width)
{
    char buffer[64];
    if (!(width >= 1e-6) || !(std::fabs(value) < 1e12)) {
        std::snprintf(buffer, sizeof buffer, "%.8g", value);
        return buffer;
    }
    const int digits = 2 - static_cast<int>(std::floor(std::log10(width)));
    std::snprintf(buffer, sizeof buffer, "%.*f", std::clamp(digits, 0, 8), value);
    std::string text = buffer;
    if (text.find('.') != std::string::npos) {
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.') text.pop_back();
    }
    return text == "-0" ? "0" : text;
}

}  // namespace pcm
