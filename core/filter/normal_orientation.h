// Which of the two sides of a surface its normals point to.
#pragma once

#include "pcm/cloud/vector.h"

#include <cstdint>

namespace pcm {

struct NormalOrientation {
    enum class Rule : std::uint8_t {
        consistent,  // the same side along each surface: see orientation_propagation.h
        direction,   // to the half space of a vector: n . vector >= 0
        viewpoint,   // towards a point, where the scanner stood
    };
    Rule rule = Rule::consistent;
    Vec3d vector{0, 0, 1};  // a direction, not 0; or a viewpoint, source coordinates
};

// Whether the normal of the point `p` has to be turned around, by a direction or a viewpoint. Normals at a right angle
// to the rule stay.
inline bool is_to_flip(const NormalOrientation& orientation, const Vec3d& normal, const Vec3d& p)
{
    const bool to_point = orientation.rule == NormalOrientation::Rule::viewpoint;
    return dot(normal, to_point ? orientation.vector - p : orientation.vector) < 0;
}

}  // namespace pcm
