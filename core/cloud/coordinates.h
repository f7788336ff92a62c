// Which numbers are coordinates of clouds, and of what people give for a cloud: places, cameras, corners, measures.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <cmath>
#include <string>

namespace pcm {

// What trees hold, source units. Squares of distances are then finite doubles everywhere. Nothing measured comes near.
inline constexpr double largest_coordinate = 0x1p500;  // 3.3e150

// False for NaN too.
inline bool is_coordinate(double v) { return std::fabs(v) <= largest_coordinate; }
inline bool is_place(const Vec3d& v) { return is_coordinate(v[0]) && is_coordinate(v[1]) && is_coordinate(v[2]); }

// Message about a number or a place that is not a coordinate: "the height 1e+308 is out of range: ...".
inline std::string not_a_coordinate(const std::string& number, bool finite)
{
    if (!finite) return number + " is not finite";
    return number + " is out of range: coordinates and lengths are at most " + brief(largest_coordinate);
}

// Throws Error(invalid_argument), "WHAT 1e+308 0 0 is out of range: ...", unless is_place(). `what` is a noun: "the
// place".
inline void require_place(const std::string& what, const Vec3d& v)
{
    if (!is_place(v))
        throw Error(ErrorCode::invalid_argument, {}, not_a_coordinate(what + " " + exact(v), is_finite(v)));
}
// The same of one coordinate or length.
inline void require_coordinate(const std::string& what, double v)
{
    if (!is_coordinate(v))
        throw Error(ErrorCode::invalid_argument, {}, not_a_coordinate(what + " " + exact(v), std::isfinite(v)));
}

}  // namespace pcm
