// Surfaces that can be fitted to points: planes, cylinders, spheres, cones, tori. Unbounded where the surface is;
// shapes/bounds.h says which part of one there is.
#pragma once

#include "pcm/cloud/vector.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

enum class ShapeKind : std::uint8_t { plane, cylinder, sphere, cone, torus };

// Lengths are in source units, angles in radians. What a kind does not name is not used by it.
struct Shape {
    ShapeKind kind = ShapeKind::plane;
    Vec3d point{};        // of the plane; of the cylinder's axis; centre of sphere and torus; apex of the cone
    Vec3d axis{0, 0, 1};  // unit: normal of the plane; of cylinder and torus; of the cone, from its apex inwards
    double radius = 0;    // of cylinder and sphere; of the circle that the torus' tube follows
    double second = 0;    // the cone's half angle, between 0 and pi / 2; the radius of the torus' tube
};

// What is the same for all shapes of a kind. One row per kind: shapes/shape.cpp.
struct ShapeTraits {
    ShapeKind kind;
    const char* name;   // in commands and files: "plane"
    const char* label;  // for people: "Plane"
    const char* form;   // of text_of(): "plane X Y Z NX NY NZ"
    bool axis, radius, second;
};

const std::vector<ShapeTraits>& shape_kinds();  // in the order of the enumerators
const ShapeTraits& traits_of(ShapeKind kind);
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

// Above 0 on the side where normal_at() points: with d = p - point, n the axis, h = n . d and q = |n x d|
//     plane     h
//     cylinder  q - radius
//     sphere    |d| - radius
//     cone      q cos(second) - h sin(second); |d| where the apex is nearest
//     torus     sqrt((q - radius)^2 + h^2) - second
// so cylinders, spheres, cones and tori have their normals outwards. Exact to about |d| * 1e-16 for a unit axis.
double signed_distance(const Shape& shape, const Vec3d& p);
inline double distance_to(const Shape& shape, const Vec3d& p) { return std::fabs(signed_distance(shape, p)); }

// Unit normal of the surface at the place nearest to p; any one of them where several are nearest (p on an axis).
Vec3d normal_at(const Shape& shape, const Vec3d& p);

}  // namespace pcm
