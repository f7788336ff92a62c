// Turns an attribute of any type into 8-bit colours, for a rasteriser or for the vertices of a mesh. No OpenGL here.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/point_batch.h"

#include <array>
#include <bitset>
#include <cstdint>
#include <string_view>
#include <vector>

namespace pcm {

// The attribute that colours are made from.
enum class ColourSource : std::uint8_t { none, rgb, intensity, classification, attribute };

std::string_view attribute_of(ColourSource source);  // empty for none, and for one that a user names
inline std::uint32_t components_of(ColourSource source) { return source == ColourSource::rgb ? 3 : 1; }  // at least
// Whether it is one number per point, shown by a colour ramp.
inline bool is_value(ColourSource source)
{
    return source == ColourSource::intensity || source == ColourSource::attribute;
}

// The map of raw values to 0..255: (value - low) / (high - low), clamped. Chosen once per cloud from a sample of the
// whole (view/value_range.h), so that every chunk of a picture has the same scale.
struct ColourScale {
    double low = 0;
    double high = 1;

    // Integer rgb: the type's range, or 0..255 when a 16-bit or wider type holds no more than that (many LAS files do).
    // Floating rgb: 0..1, or 0..255 when values are above 1. Intensity: from the 1st to the 99th percentile, as
    // sensors fill very different parts of the range.
    static ColourScale of(const Column& column, ColourSource colour);
};

// For ColourSource::rgb and ::intensity: RGBA8, 4 bytes per point, alpha 255; grey for an attribute of one component.
// NaN is black.
void make_colours(const Column& column, const ColourScale& scale, std::vector<std::uint8_t>& rgba);

// One float per point: where (value - low) / (high - low) lies, value = raw * scale + offset of the attribute's
// component. NaN becomes no_value.
void make_values(const Column& column, const Attribute& attribute, std::uint32_t component, double low, double high,
                 std::vector<float>& values);
inline constexpr float no_value = -1e30f;

// For ColourSource::classification: the colour of each point's class, raw * scale + offset rounded. Classes 0 to 18 of
// LAS 1.4 (ASPRS) have colours customary on maps; reserved and user-defined ones (19 to 255) have a bright colour each
// from a fixed sequence. Other values, NaN included, are magenta.
void make_class_colours(const Column& column, const Attribute& attribute, std::vector<std::uint8_t>& rgba);
std::array<std::uint8_t, 3> class_colour(double number);

// Which classes occur: 0 to 255, and at the end all other numbers.
using ClassSet = std::bitset<257>;
void add_classes(const Column& column, const Attribute& attribute, ClassSet& classes);

}  // namespace pcm
