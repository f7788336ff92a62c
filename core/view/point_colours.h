// Turns an attribute of any type into 8-bit colours, for a rasteriser or for the vertices of a mesh. No OpenGL here.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/attribute.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace pcm {

// The attribute that colours are made from.
enum class ColourSource : std::uint8_t { none, rgb, intensity, classification };

std::string_view attribute_of(ColourSource source);  // empty for none
inline std::uint32_t components_of(ColourSource source) { return source == ColourSource::rgb ? 3 : 1; }  // at least
// Whether its values have a ColourScale, which the coarsest chunk sets; classes have not.
inline bool is_scaled(ColourSource source) { return source == ColourSource::rgb || source == ColourSource::intensity; }

// Maps raw values to 0..255: (value - low) / (high - low), clamped. Chosen once per cloud from its coarsest chunk,
// which is a sample of the whole, so that every chunk of a picture has the same scale.
struct ColourScale {
    double low = 0;
    double high = 1;

    // Integer rgb: the type's range, or 0..255 when a 16-bit or wider type holds no more than that (many LAS files do).
    // Floating rgb: 0..1, or 0..255 when values are above 1. Intensity: from the 0.5th to the 99.5th percentile, as
    // sensors fill very different parts of the range.
    static ColourScale of(const Column& column, ColourSource colour);
};

// For ColourSource::rgb and ::intensity: RGBA8, 4 bytes per point, alpha 255; grey where the attribute has one
// component. NaN is black.
void make_colours(const Column& column, const ColourScale& scale, std::vector<std::uint8_t>& rgba);

// For ColourSource::classification: the colour of each point's class, raw * scale + offset rounded. Classes 0 to 18 of
// LAS 1.4 (ASPRS) have the colours that maps commonly use; reserved and user-defined classes (19 to 255) have one
// bright colour each from a fixed sequence. NaN and values outside 0 to 255 are magenta.
void make_class_colours(const Column& column, const Attribute& attribute, std::vector<std::uint8_t>& rgba);
std::array<std::uint8_t, 3> class_colour(double number);

}  // namespace pcm
