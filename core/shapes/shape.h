// Surfaces that can be fitted to points: planes, cylinders, spheres, cones, tori. Unbounded where the surface is;
// shapes/bounds.h says which part of one there is. A kind is a row of shapes/shape_traits.h.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/shapes/shape_traits.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Lengths are in source units, angles in radians. What a kind does not name is not used by it.
struct Shape {
    ShapeKind kind = ShapeKind::plane;
    Vec3d point{};        // a point of the plane or the cylinder's axis; centre of sphere and torus; apex of the cone
    Vec3d axis{0, 0, 1};  // unit: normal of the plane; of cylinder and torus; of the cone, from its apex inwards
    double radius = 0;    // radius of cylinder, sphere, and the circle that the torus' tube follows
    double second = 0;    // the cone's half angle, between 0 and pi / 2; the radius of the torus' tube
};

inline bool ShapeTraits::has_size(double Shape::*value) const
{
    for (const ShapeSize& size : sizes)
        if (size.value == value) return true;
    return false;
}
inline bool ShapeTraits::has_radius() const { return has_size(&Shape::radius); }

std::optional<ShapeKind> shape_kind(const std::string& name);

// "plane X Y Z NX NY NZ", "cylinder X Y Z AX AY AZ RADIUS", "sphere X Y Z RADIUS", "cone X Y Z AX AY AZ DEGREES" with
// half the opening angle, "torus X Y Z AX AY AZ RADIUS TUBE"; numbers are separated by blanks or commas. The axis may
// have any length but 0, the shape gets the unit one. Throws Error(invalid_argument), saying what was expected, and
// what check() throws.
Shape parse_shape(const std::string& text);
std::string text_of(const Shape& shape);  // in that form, with all digits

// Throws Error(invalid_argument) for numbers that are not finite, an axis of length 0, radii that are not above 0, a
// cone's angle out of range, a tube as wide as its circle or wider.
void check(const Shape& shape);
// Whether the numbers are finite and check() finds no fault with the sizes; the axis may have any length.
bool is_proper(const Shape& shape);

// Above 0 on the side where normal_at() points: with d = p - point, n the axis, h = n . d and q = |n x d|
//     plane     h
//     cylinder  q - radius
//     sphere    |d| - radius
//     cone      q cos(second) - h sin(second); |d| where the apex is nearest
//     torus     sqrt((q - radius)^2 + h^2) - second
// so cylinders, spheres, cones and tori have their normals outwards. Exact to about |d| * 1e-16 for a unit axis.
inline double signed_distance(const Shape& shape, const Vec3d& p)
{
    return traits_of(shape.kind).signed_distance(shape, p);
}
inline double distance_to(const Shape& shape, const Vec3d& p) { return std::fabs(signed_distance(shape, p)); }

// Unit normal of the surface at the place nearest to p; any one of them where several are nearest (p on an axis).
inline Vec3d normal_at(const Shape& shape, const Vec3d& p) { return traits_of(shape.kind).normal_at(shape, p); }

// The least radius of a shape that has one, of a torus its tube's; 0: it has none.
double narrowest_radius(const Shape& shape);

}  // namespace pcm
