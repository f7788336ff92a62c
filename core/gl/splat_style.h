// How one cloud looks. No OpenGL here.
#pragma once

#include "pcm/cloud/attribute.h"

#include <array>
#include <cstdint>
#include <string>

namespace pcm {

// What a point is drawn as (Botsch and Kobbelt 2003; Zwicker et al. 2004 for the affine one).
enum class SplatMode : std::uint8_t {
    constant,  // a square of a fixed number of pixels
    dynamic,   // a square as large as a sphere of the point's radius appears; reads `radius`
    affine,  // the point's disc, projected as if the view were parallel around its centre; reads `radius` and `normal`
    perspective,  // the disc itself, each fragment's ray cut with its plane, depth included; reads `radius` and
                  // `normal`
};
const char* name_of(SplatMode mode);  // "constant", ...

enum class ColourMode : std::uint8_t {
    rgb,
    intensity,
    height,          // along the whole cloud's box
    classification,  // the classes of LAS 1.4, each in its own colour
    level,           // how coarse the level is that the chunk's points begin
    error,           // how far apart, on the screen, points are where the chunk is the finest that is drawn
    uniform,
};
const char* name_of(ColourMode mode);  // "rgb", ...

struct CloudStyle {
    SplatMode splats = SplatMode::constant;
    ColourMode colour = ColourMode::rgb;
    float point_size_px = 2;  // constant splats: side of the square, clamped to what the driver can
    float radius_scale = 1;   // the others: factor on the points' radii
    std::array<float, 3> uniform_colour{0.75f, 0.75f, 0.75f};
};
inline bool operator==(const CloudStyle& a, const CloudStyle& b)
{
    return a.splats == b.splats && a.colour == b.colour && a.point_size_px == b.point_size_px &&
           a.radius_scale == b.radius_scale && a.uniform_colour == b.uniform_colour;
}
inline bool operator!=(const CloudStyle& a, const CloudStyle& b) { return !(a == b); }

// The nearest style that a cloud of this schema supports: without normals dynamic splats, without radii constant ones;
// without rgb intensity, without intensity or classes height. `notice`, which may be null, becomes a sentence that says
// what is missing and what is shown instead; empty when nothing is missing.
CloudStyle usable_style(const CloudStyle& asked, const Schema& schema, std::string* notice);

}  // namespace pcm
