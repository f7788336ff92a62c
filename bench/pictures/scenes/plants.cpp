// Trees and shrubs of trunks, branches and leaves, and the forest that is made of them.
#include "bench/pictures/scenes/scenes.h"

#include "pcm/generate/construction.h"

#include <cmath>

namespace pcm::bench {

using namespace scene;

namespace {

Vec3d random_direction(Random& random)
{
    const double z = random.between(-1, 1), flat = std::sqrt(1 - z * z);
    double sine, cosine;
    sine_cosine(random.unit(), sine, cosine);
    return {flat * cosine, flat * sine, z};
}

void add_leaf(Site& site, const Vec3d& centre, double radius, const Colour& colour, std::uint16_t label, Random& random)
{
    Shape s;
    s.kind = Shape::Kind::disc;
    s.material = Material::leaf;
    s.classification = 5;
    s.centre = centre;
    s.radius = radius;
    s.n = random_direction(random);
    s.u = unit(cross(s.n, std::abs(s.n[2]) < 0.9 ? up : Vec3d{1, 0, 0}));
    s.v = cross(s.n, s.u);
    s.id = label;
    const double shade = random.between(0.75, 1.3);
    for (std::size_t c = 0; c < 3; ++c) s.colour[c] = shade * colour[c];
    site.shapes.push_back(s);
}

}  // namespace

Scene empty_scene(const char* name, double side, std::uint64_t seed)
{
    Scene scene;
    scene.name = name;
    scene.site.side = side;
    scene.site.block = 1000;
    scene.site.street = -10;  // none
    scene.site.seed = seed;
    return scene;
}

void add_cylinder(Site& site, const Vec3d& from, const Vec3d& to, double radius, Material material,
                  const Colour& colour, std::uint16_t label)
{
    Shape s;
    s.kind = Shape::Kind::cylinder;
    s.material = material;
    s.colour = colour;
    s.centre = 0.5 * (from + to);
    s.n = unit(to - from);
    s.u = unit(cross(s.n, std::abs(s.n[2]) < 0.9 ? up : Vec3d{1, 0, 0}));
    s.v = cross(s.n, s.u);
    s.half_v = 0.5 * length(to - from);
    s.radius = radius;
    s.id = label;
    site.shapes.push_back(s);
}

void plant(Site& site, const Vec3d& foot, const TreeDesign& design, std::uint16_t label, Random& random)
{
    const Colour bark{104, 84, 66};
    const double trunk = 0.016 * design.height;
    const Vec3d top = foot + 0.75 * design.height * up;
    if (design.height > 3) {
        add_cylinder(site, foot - 0.3 * up, foot + 0.45 * design.height * up, trunk, Material::bark, bark, label);
        add_cylinder(site, foot + 0.45 * design.height * up, top, 0.6 * trunk, Material::bark, bark, label);
    }
    for (int i = 0; i < design.clumps; ++i) {
        double sine, cosine;
        sine_cosine((i + 0.5 * random.unit()) / 5.0, sine, cosine);
        const double rise = 0.42 + 0.5 * (i + 0.5) / design.clumps, aside = 0.19 * design.height * (1.25 - rise);
        const Vec3d centre = foot + Vec3d{aside * cosine, aside * sine, rise * design.height};
        if (design.height > 3)
            add_cylinder(site, foot + 0.8 * rise * design.height * up, centre, 0.25 * trunk, Material::bark, bark,
                         label);
        for (int j = 0; j < design.leaves / design.clumps; ++j) {
            // Denser towards the outside, where the light is.
            const double from_centre = design.clump * std::sqrt(std::sqrt(random.unit()));
            const Vec3d at = centre + from_centre * random_direction(random);
            add_leaf(site, at, design.leaf * random.between(0.7, 1.2), design.green, label, random);
        }
    }
}

Scene make_forest(std::uint64_t seed)
{
    Scene scene = empty_scene("forest", 40, seed);
    Site& site = scene.site;
    site.ground = Ground(seed);
    Random random(hash(seed, 0x666f72));
    const auto at = [&](double x, double y, double over) { return Vec3d{x, y, site.ground.height(x, y) + over}; };
    const Vec3d clearing = at(20, 7, 0);
    std::uint16_t label = 1;
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) {
            const double x = 4 + 6.2 * i + random.between(-1.6, 1.6), y = 4 + 6.2 * j + random.between(-1.6, 1.6);
            if (std::hypot(x - clearing[0], y - clearing[1]) < 3.5) continue;
            TreeDesign design;
            design.height = random.between(8, 13);
            design.green = {random.between(66, 100), random.between(104, 136), random.between(38, 58)};
            plant(site, at(x, y, 0), design, label++, random);
        }
    for (int i = 0; i < 25; ++i) {
        TreeDesign shrub;
        shrub.height = random.between(0.6, 1.5);
        shrub.clump = 0.4 * shrub.height;
        shrub.leaf = 0.05;
        shrub.clumps = 3;
        shrub.leaves = 180;
        shrub.green = {random.between(96, 132), random.between(124, 150), 62};
        const double x = random.between(2, 38), y = random.between(2, 38);
        if (std::hypot(x - clearing[0], y - clearing[1]) > 2.5) plant(site, at(x, y, -0.3), shrub, label++, random);
    }
    scene.scanners = {{at(18, 8, 1.8), at(18, 8, 1.8), 1, -180, 180, -50, 75},
                      {at(23.5, 16, 1.8), at(23.5, 16, 1.8), 1, -180, 180, -50, 75},
                      {at(12, 21, 1.8), at(12, 21, 1.8), 0.7, -180, 180, -50, 75},
                      {{20, 0, 60}, {20, 40, 60}, 0.8, 0, 0, 0, 25}};
    scene.views = {{"forest", at(20, 5.5, 1.7), at(20.5, 20, 3.4), 45},
                   {"crown", at(27, 6, 8.2), at(20.5, 14.5, 7.6), 45}};
    return scene;
}

}  // namespace pcm::bench
