// How one cloud looks. No OpenGL here.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/gl/colour_modes.h"
#include "pcm/gl/splat_modes.h"

#include <array>
#include <string>

namespace pcm {

struct CloudStyle {
    SplatMode splats = SplatMode::adaptive;
    ColourMode colour = ColourMode::rgb;
    float point_size_px = 2;  // SplatShape::pixels: side of the square, clamped to the driver's range
    float radius_scale = 1;   // the other shapes: factor on the points' radii or sizes
    std::array<float, 3> uniform_colour{0.75f, 0.75f, 0.75f};
};
inline bool operator==(const CloudStyle& a, const CloudStyle& b)
{
    return a.splats == b.splats && a.colour == b.colour && a.point_size_px == b.point_size_px &&
           a.radius_scale == b.radius_scale && a.uniform_colour == b.uniform_colour;
}
inline bool operator!=(const CloudStyle& a, const CloudStyle& b) { return !(a == b); }

// The nearest style that a cloud of this schema supports: without normals adaptive splats;
// without rgb intensity, without intensity or classes height. `notice`, which may be null, becomes a sentence that says
// what is missing and what is shown instead; empty when nothing is missing.
CloudStyle usable_style(const CloudStyle& asked, const Schema& schema, std::string* notice);

}  // namespace pcm
