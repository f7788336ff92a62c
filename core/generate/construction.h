// Builds houses, halls, tanks and trees from shapes.
#pragma once

#include "pcm/generate/determinism.h"
#include "pcm/generate/site.h"

#include <cstddef>
#include <cstdint>

namespace pcm::scene {

inline constexpr Vec3d up{0, 0, 1};

// The local coordinate system of a building or plant: its foot and its horizontal axes.
struct Frame {
    Vec3d origin;
    Vec3d x, y;

    Frame(const Vec3d& at, double turns) : origin(at)
    {
        double s, c;
        sine_cosine(turns, s, c);
        x = {c, s, 0};
        y = {-s, c, 0};
    }
    Vec3d at(double a, double b, double height) const { return origin + a * x + b * y + height * up; }
};

// Adds shapes to a site, with their primitives of the ground truth. Lengths in metres. The site must outlive it.
class Construction {
public:
    explicit Construction(Site& site) : site_(site) {}

    // Whether the ground truth has room for this many more primitives: their ids have 16 bits.
    bool room_for(std::size_t primitives) const { return site_.primitives.size() + primitives <= most_primitives; }

    void rectangle(const Vec3d& centre, const Vec3d& u, const Vec3d& v, double half_u, double half_v, double gable,
                   Material material, const Colour& colour, std::uint8_t classification);
    void disc(const Vec3d& centre, double radius, Material material, const Colour& colour);
    void cylinder(const Vec3d& from, const Vec3d& to, double radius, Material material, const Colour& colour);
    // The part of a sphere above its circle of `rim_radius`; `rise` is its height.
    void dome(const Vec3d& rim_centre, double rim_radius, double rise, const Colour& colour);
    void sphere(const Vec3d& centre, double radius, const Colour& colour);
    // Adds nothing where the tree would reach beyond the site.
    void tree(double x, double y, double height, Random& random);

    // Four walls from `below` under the foot to `height` over it; the two that face along x have gables.
    void walls(const Frame& frame, double half_x, double half_y, double below, double height, double gable,
               Material material, const Colour& colour, std::uint8_t classification);
    void house(const Frame& frame, double half_x, double half_y, double eaves, double ridge, Random& random);
    // With ducts on its roof.
    void hall(const Frame& frame, double half_x, double half_y, double height, Random& random);
    // A concrete plate whose upper side is at the foot.
    void slab(const Frame& frame, double half_x, double half_y);

private:
    static constexpr std::size_t most_primitives = 60000;

    std::uint16_t new_primitive(const ScenePrimitive& primitive);
    double ground(double x, double y) const { return site_.ground.height(x, y); }

    Site& site_;
};

}  // namespace pcm::scene
