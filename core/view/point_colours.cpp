#include "pcm/view/point_colours.h"

#include "pcm/cloud/with_type.h"
#include "pcm/view/value_range.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <type_traits>

namespace pcm {

namespace {

// Calls `use` with a pointer to the column's values, of their type.
template <class Use>
void with_values(const Column& column, const Use& use)
{
    with_type(column.type(), [&](auto zero) { use(column.as<decltype(zero)>()); });
}

}  // namespace

std::string_view attribute_of(ColourSource source)
{
    switch (source) {
        case ColourSource::none:
            return {};
        case ColourSource::rgb:
            return attribute_name::rgb;
        case ColourSource::intensity:
            return attribute_name::intensity;
        case ColourSource::classification:
            return attribute_name::classification;
        case ColourSource::attribute:
            return {};
    }
    return {};
}

ColourScale ColourScale::of(const Column& column, ColourSource colour)
{
    std::vector<double> values;
    const std::size_t scalars = column.size() * column.components();
    values.reserve(scalars);
    double type_maximum = 1;
    with_values(column, [&](const auto* raw) {
        using T = std::remove_cv_t<std::remove_pointer_t<decltype(raw)>>;
        if constexpr (std::is_integral_v<T>) type_maximum = static_cast<double>(std::numeric_limits<T>::max());
        for (std::size_t i = 0; i < scalars; ++i) {
            const auto value = static_cast<double>(raw[i]);
            if (std::isfinite(value)) values.push_back(value);
        }
    });
    if (values.empty()) return {};
    if (colour == ColourSource::rgb) {
        const double most = *std::max_element(values.begin(), values.end());
        if (type_maximum == 1) return {0, most > 1 ? 255.0 : 1.0};
        return {0, type_maximum > 255 && most <= 255 ? 255.0 : type_maximum};
    }
    const ValueSummary summary = summary_of(values);
    // All values equal: bright rather than black.
    if (summary.is_constant()) return {summary.least - 1, summary.least};
    const ValueRange range = linear_range(summary);
    return {range.low, range.high};
}

void make_colours(const Column& column, const ColourScale& scale, std::vector<std::uint8_t>& rgba)
{
    const std::size_t points = column.size();
    const std::size_t components = column.components();
    rgba.resize(4 * points);
    const double low = scale.low;
    const double factor = 255 / (scale.high - scale.low);
    with_values(column, [&](const auto* raw) {
        const auto byte = [&](std::size_t i) {
            const double v = (static_cast<double>(raw[i]) - low) * factor + 0.5;
            return static_cast<std::uint8_t>(v >= 255 ? 255 : v > 0 ? v : 0);  // NaN: 0
        };
        for (std::size_t p = 0; p < points; ++p) {
            std::uint8_t* to = rgba.data() + 4 * p;
            for (std::size_t c = 0; c < 3; ++c) to[c] = byte(p * components + std::min(c, components - 1));
            to[3] = 255;
        }
    });
}

std::array<std::uint8_t, 3> class_colour(double number)
{
    using Colour = std::array<std::uint8_t, 3>;
    static constexpr Colour named[] = {
        {150, 150, 150},  // 0 never classified
        {190, 190, 190},  // 1 unclassified
        {166, 116, 70},   // 2 ground
        {178, 223, 138},  // 3 low vegetation
        {102, 189, 99},   // 4 medium vegetation
        {27, 120, 55},    // 5 high vegetation
        {230, 85, 60},    // 6 building
        {255, 0, 127},    // 7 low point (noise)
        {120, 120, 180},  // 8 reserved (model key point before LAS 1.4)
        {50, 115, 220},   // 9 water
        {120, 70, 140},   // 10 rail
        {95, 95, 105},    // 11 road surface
        {200, 180, 210},  // 12 reserved (overlap before LAS 1.4)
        {255, 215, 60},   // 13 wire, guard
        {255, 170, 0},    // 14 wire, conductor
        {190, 120, 20},   // 15 transmission tower
        {140, 220, 230},  // 16 wire-structure connector
        {215, 150, 110},  // 17 bridge deck
        {255, 60, 200},   // 18 high noise
    };
    const double rounded = std::floor(number + 0.5);
    if (!(rounded >= 0 && rounded <= 255)) return {255, 0, 255};
    const auto c = static_cast<unsigned>(rounded);
    if (c < std::size(named)) return named[c];
    // Hues a golden section of the circle apart: neighbours in number are far apart in colour.
    const double hue = std::fmod(c * 0.618033988749895, 1.0) * 6;
    const auto channel = [&](double place) {
        const double distance = std::abs(std::fmod(hue + place, 6.0) - 3);  // 0 at the channel's opposite hue
        return static_cast<std::uint8_t>(64 + 191 * std::clamp(distance - 1, 0.0, 1.0));
    };
    return {channel(0), channel(4), channel(2)};
}

void make_class_colours(const Column& column, const Attribute& attribute, std::vector<std::uint8_t>& rgba)
{
    std::array<std::array<std::uint8_t, 3>, 256> palette;
    for (std::size_t c = 0; c < palette.size(); ++c) palette[c] = class_colour(static_cast<double>(c));
    const std::array<std::uint8_t, 3> other = class_colour(-1);
    const std::size_t points = column.size();
    const std::size_t components = column.components();
    rgba.resize(4 * points);
    with_values(column, [&](const auto* raw) {
        for (std::size_t p = 0; p < points; ++p) {
            const double number =
                std::floor(static_cast<double>(raw[p * components]) * attribute.scale + attribute.offset + 0.5);
            const auto& colour = number >= 0 && number <= 255 ? palette[static_cast<std::size_t>(number)] : other;
            std::copy(colour.begin(), colour.end(), rgba.begin() + static_cast<std::ptrdiff_t>(4 * p));
            rgba[4 * p + 3] = 255;
        }
    });
}

void make_values(const Column& column, const Attribute& attribute, std::uint32_t component, double low, double high,
                 std::vector<float>& values)
{
    const std::size_t points = column.size();
    const std::size_t components = column.components();
    values.resize(points);
    const double width = high - low;
    with_values(column, [&](const auto* raw) {
        for (std::size_t p = 0; p < points; ++p) {
            const double value =
                static_cast<double>(raw[p * components + component]) * attribute.scale + attribute.offset;
            const double place = (value - low) / width;
            // Far outside of any range that shows something, and larger than no_value.
            values[p] = std::isnan(place) ? no_value : static_cast<float>(std::clamp(place, -1e20, 1e20));
        }
    });
}

void add_classes(const Column& column, const Attribute& attribute, ClassSet& classes)
{
    const std::size_t components = column.components();
    with_values(column, [&](const auto* raw) {
        for (std::size_t p = 0; p < column.size(); ++p) {
            const double number =
                std::floor(static_cast<double>(raw[p * components]) * attribute.scale + attribute.offset + 0.5);
            classes.set(number >= 0 && number <= 255 ? static_cast<std::size_t>(number) : 256);
        }
    });
}

}  // namespace pcm
