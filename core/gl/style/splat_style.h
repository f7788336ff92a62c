// How one cloud looks. No OpenGL here.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/condition.h"
#include "pcm/gl/style/colour_modes.h"
#include "pcm/gl/style/splat_modes.h"
#include "pcm/view/value_range.h"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

struct CloudStyle {
    SplatMode splats = SplatMode::fitted;
    ColourMode colour = ColourMode::rgb;
    float point_size_px = 2;  // SplatShape::pixels: side of the square, clamped to the driver's range
    float radius_scale = 1;   // the other shapes: factor on the points' radii or sizes
    std::array<float, 3> uniform_colour{0.75f, 0.75f, 0.75f};
    std::string attribute;  // for ColourMode::attribute, as place_of() reads it: "gps_time", "rgb[0]"
    ColourRamp ramp = ColourRamp::automatic;
    // Of ColourMode::rgb, for scans whose colours are dark: a colour, from 0 to 1, is shown as (colour * brightness) ^
    // (1 / gamma). 1: as it is in the cloud.
    float brightness = 1, gamma = 1;
    // For modes that has_range(), or what is shown in place of others: the values at the ramp's ends. Absent: found in
    // a sample of the cloud.
    std::optional<ValueRange> range;
    // Only points that meet all of these are shown. One on an attribute that a cloud lacks leaves that cloud as it is.
    std::vector<Condition> where;
};
bool operator==(const CloudStyle& a, const CloudStyle& b);
inline bool operator!=(const CloudStyle& a, const CloudStyle& b) { return !(a == b); }

// Where the values of a cloud lie on its ramp.
struct ShownValues {
    std::optional<ValueRange>
        range;  // at the ramp's ends; absent: 0 to 1 of what the vertices hold, or the whole height
    // The numbers in the vertices are 0 and 1 for these values (Colouring::value).
    double stored_low = 0, stored_high = 1;
    double shade_exponent = 1;  // Colouring::shaded_height: of the numbers in the vertices, for the brightness
};
inline bool operator==(const ShownValues& a, const ShownValues& b)
{
    return a.range == b.range && a.stored_low == b.stored_low && a.stored_high == b.stored_high &&
           a.shade_exponent == b.shade_exponent;
}

// The ramp that a style means by `automatic`, else its own.
ColourRamp ramp_of(const CloudStyle& style);

// The nearest style that a cloud of this schema supports, which is also what a cloud looks like at first: without
// normals adaptive splats; without rgb classes, without these height with the intensity as brightness, without
// intensity or the named attribute height. The same where `is_blank`, which may be empty, says that the colours would
// show nothing. `notice`, which may be null, becomes a sentence that says what is missing and what is shown instead;
// empty when nothing is missing.
CloudStyle usable_style(const CloudStyle& asked, const Schema& schema, std::string* notice,
                        const std::function<bool(const CloudStyle&)>& is_blank = {});

// The attribute that the style's colours are made from; nothing for modes without one, or when the schema lacks it. Of
// rgb, its first component.
std::optional<AttributePlace> colour_place(const CloudStyle& style, const Schema& schema);

}  // namespace pcm
