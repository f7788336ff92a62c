// Surfaces given by numbers, and the distance of a point to them.
#pragma once

#include "pcm/cloud/vector.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Unbounded where the shape is. Lengths are in source units.
struct Surface {
    enum class Shape : std::uint8_t { plane, sphere, cylinder };
    Shape shape = Shape::plane;
    Vec3d origin{};       // a point of the plane or of the axis, or the centre
    Vec3d axis{0, 0, 1};  // normal of the plane or direction of the axis, of any length but 0; not used by a sphere
    double radius = 0;    // above 0; not used by a plane
};

const char* name_of(Surface::Shape shape);
std::optional<Surface::Shape> surface_shape(const std::string& name);
// "plane X Y Z NX NY NZ", "sphere X Y Z RADIUS", "cylinder X Y Z AX AY AZ RADIUS"; numbers are separated by blanks or
// commas. Throws Error(invalid_argument), saying what was expected, and what check() throws.
Surface parse_surface(const std::string& text);
std::string text_of(const Surface& surface);  // in that form, with all digits

// Throws Error(invalid_argument) for numbers that are not finite, an axis of length 0, a radius that is not above 0.
void check(const Surface& surface);

// Never negative. With d = p - origin and n the unit axis: |n . d|, | |d| - radius |, | |n x d| - radius |.
double distance_to(const Surface& surface, const Vec3d& p);

}  // namespace pcm
