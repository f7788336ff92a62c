// The area of a plane's outline, of what it is, and how sure.
#pragma once

#include "pcm/cloud/vector.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

enum class OutlineForm : std::uint8_t {
    none,       // fewer than three corners
    rectangle,  // four right angles: of the rectangle around the points, which is larger than what they cover
    convex,     // such as the hull of the points, which fills what juts in
    concave,    // follows the points' edge
};
const char* name_of(OutlineForm form);

struct OutlineArea {
    OutlineForm form = OutlineForm::none;
    double area = 0;  // squared units of the corners
    // One standard deviation; 0: not known. The surface ends somewhere between its last points and where the next would
    // be, so by half of the spacing on average: perimeter times spacing / 2, the spacing being the root of the area of
    // a point. That of a rectangle is not known: how much of it the points cover does not follow from their spacing.
    double uncertainty = 0;
};

// `corners` in order, on one plane; `points`: how many lie within it, 0: not known. Whether angles are right is known
// to 1e-6. Any thread.
OutlineArea outline_area(const std::vector<Vec3d>& corners, std::uint64_t points);

struct Primitive;
OutlineArea area_of(const Primitive& primitive);  // as the row of its kind computes it

struct ShapeBounds;
inline OutlineArea no_area(const ShapeBounds&, std::uint64_t) { return {}; }  // for kinds without outline

// "in the rectangle around its points", "in the convex outline of its points", ...; empty for none.
std::string words_of(OutlineForm form);

}  // namespace pcm
