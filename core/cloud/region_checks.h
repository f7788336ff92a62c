// What the makers of regions check of their numbers. `region` begins the message of an error.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <cmath>
#include <initializer_list>
#include <string>

namespace pcm {

[[noreturn]] inline void refuse_region(const std::string& region, const std::string& what)
{
    throw Error(ErrorCode::invalid_argument, {}, region + ": " + what);
}

inline void require_finite(const std::string& region, const char* name, const Vec3d& v)
{
    for (const double c : v)
        if (!std::isfinite(c)) refuse_region(region, std::string("its ") + name + " is not finite: " + exact(v));
}

// v / |v|. Scaled first: lengths of 1e-200 and 1e200 are fine.
inline Vec3d unit_vector(const std::string& region, const char* name, const Vec3d& v)
{
    require_finite(region, name, v);
    const double size = largest_magnitude(v);
    if (!(size > 0)) refuse_region(region, std::string("its ") + name + " has no length");
    const Vec3d near_one = v / size;
    return (1 / length(near_one)) * near_one;
}

// The vectors as a region's text, with a blank in front of each number.
inline std::string text_of(std::initializer_list<Vec3d> vectors)
{
    std::string text;
    for (const Vec3d& v : vectors) text += " " + exact(v);
    return text;
}

}  // namespace pcm
