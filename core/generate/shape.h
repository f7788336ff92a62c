// The surfaces that a generated site is made of.
#pragma once

#include "pcm/cloud/geometry.h"

#include <array>
#include <cstdint>

namespace pcm::scene {

enum class Material : std::uint8_t { brick, plaster, cladding, tiles, flat_roof, concrete, metal, paint, bark, leaf };

using Colour = std::array<double, 3>;  // 0..255

// One surface (or, for crowns, one volume of leaves).
struct Shape {
    enum class Kind : std::uint8_t { rectangle, disc, cylinder, sphere, crown };

    Kind kind = Kind::rectangle;
    Material material = Material::concrete;
    std::uint8_t classification = 0;
    std::uint16_t id = 0;  // number of its primitive in the ground truth; 0: none
    Colour colour{};
    Vec3d centre{};
    Vec3d u{1, 0, 0}, v{0, 1, 0}, n{0, 0, 1};  // orthonormal; n: normal of the plane, axis of the cylinder
    double half_u = 0, half_v = 0;             // rectangle; half_v is also half the length of a cylinder
    double gable = 0;                          // height of a gable over the rectangle's upper edge, its tip at u = 0
    double radius = 0;                         // disc, cylinder, sphere, crown
    double lowest = -1e9;                      // sphere: cut off below this height (a dome)

    Box3d box() const;
};

}  // namespace pcm::scene
