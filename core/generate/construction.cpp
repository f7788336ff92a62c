#include "pcm/generate/construction.h"

#include <cmath>

namespace pcm::scene {
namespace {

constexpr std::uint8_t class_vegetation = 5;
constexpr std::uint8_t class_building = 6;
constexpr std::uint8_t class_paved = 11;
constexpr std::uint8_t class_plant = 19;

}  // namespace

std::uint16_t Construction::new_primitive(const ScenePrimitive& primitive)
{
    site_.primitives.push_back(primitive);
    site_.primitives.back().id = static_cast<std::uint16_t>(site_.primitives.size());
    return site_.primitives.back().id;
}

void Construction::rectangle(const Vec3d& centre, const Vec3d& u, const Vec3d& v, double half_u, double half_v,
                             double gable, Material material, const Colour& colour, std::uint8_t classification)
{
    Shape s;
    s.kind = Shape::Kind::rectangle;
    s.material = material;
    s.classification = classification;
    s.colour = colour;
    s.centre = centre;
    s.u = u;
    s.v = v;
    s.n = unit(cross(u, v));
    s.half_u = half_u;
    s.half_v = half_v;
    s.gable = gable;
    s.id = new_primitive({ScenePrimitive::Kind::plane, 0, centre, s.n, 0, 0});
    site_.shapes.push_back(s);
}

void Construction::disc(const Vec3d& centre, double radius, Material material, const Colour& colour)
{
    Shape s;
    s.kind = Shape::Kind::disc;
    s.material = material;
    s.classification = class_plant;
    s.colour = colour;
    s.centre = centre;
    s.radius = radius;
    s.id = new_primitive({ScenePrimitive::Kind::plane, 0, centre, s.n, 0, 0});
    site_.shapes.push_back(s);
}

void Construction::cylinder(const Vec3d& from, const Vec3d& to, double radius, Material material, const Colour& colour)
{
    Shape s;
    s.kind = Shape::Kind::cylinder;
    s.material = material;
    s.colour = colour;
    s.centre = 0.5 * (from + to);
    s.n = unit(to - from);
    s.u = unit(cross(s.n, std::abs(s.n[2]) < 0.9 ? up : Vec3d{1, 0, 0}));
    s.v = cross(s.n, s.u);
    s.half_v = 0.5 * std::sqrt(dot(to - from, to - from));
    s.radius = radius;
    s.classification = material == Material::bark ? class_vegetation : class_plant;
    if (material != Material::bark)  // trunks are not part of the ground truth
        s.id = new_primitive({ScenePrimitive::Kind::cylinder, 0, s.centre, s.n, radius, 0});
    site_.shapes.push_back(s);
}

void Construction::dome(const Vec3d& rim_centre, double rim_radius, double rise, const Colour& colour)
{
    Shape s;
    s.kind = Shape::Kind::sphere;
    s.material = Material::paint;
    s.classification = class_plant;
    s.colour = colour;
    s.radius = (rim_radius * rim_radius + rise * rise) / (2 * rise);
    s.centre = rim_centre + (rise - s.radius) * up;
    s.lowest = rim_centre[2];
    s.id = new_primitive({ScenePrimitive::Kind::sphere, 0, s.centre, {}, s.radius, 0});
    site_.shapes.push_back(s);
}

void Construction::sphere(const Vec3d& centre, double radius, const Colour& colour)
{
    Shape s;
    s.kind = Shape::Kind::sphere;
    s.material = Material::paint;
    s.classification = class_plant;
    s.colour = colour;
    s.centre = centre;
    s.radius = radius;
    s.id = new_primitive({ScenePrimitive::Kind::sphere, 0, centre, {}, radius, 0});
    site_.shapes.push_back(s);
}

void Construction::tree(double x, double y, double height, Random& random)
{
    const double reach = 0.3 * height;
    if (x < reach || y < reach || x > site_.side - reach || y > site_.side - reach) return;
    const Vec3d foot{x, y, ground(x, y)};
    cylinder(foot - 0.3 * up, foot + 0.6 * height * up, 0.025 * height, Material::bark, {92, 74, 58});
    Shape s;
    s.kind = Shape::Kind::crown;
    s.material = Material::leaf;
    s.classification = class_vegetation;
    const double green = random.between(0.8, 1.15);
    s.colour = {green * random.between(62, 96), green * random.between(98, 128), green * random.between(36, 56)};
    if (random.chance(0.3)) {  // a conifer: tiers that get smaller
        s.colour = {green * 44, green * 82, green * 48};
        for (int tier = 0; tier < 4; ++tier) {
            s.radius = height * (0.19 - 0.04 * tier);
            s.centre = foot + height * (0.3 + 0.19 * tier) * up;
            site_.shapes.push_back(s);
        }
        return;
    }
    for (int clump = 0; clump < 4; ++clump) {
        double sine, cosine;
        sine_cosine((clump + random.unit()) / 4, sine, cosine);
        s.radius = height * random.between(0.16, 0.22);
        const double aside = clump == 3 ? 0 : 0.13 * height;
        s.centre = foot + Vec3d{aside * cosine, aside * sine, height * (clump == 3 ? 0.8 : random.between(0.55, 0.7))};
        site_.shapes.push_back(s);
    }
}

void Construction::walls(const Frame& frame, double half_x, double half_y, double below, double height, double gable,
                         Material material, const Colour& colour, std::uint8_t classification)
{
    const double middle = 0.5 * (height - below);
    const double half_z = 0.5 * (height + below);
    rectangle(frame.at(0, -half_y, middle), frame.x, up, half_x, half_z, 0, material, colour, classification);
    rectangle(frame.at(0, half_y, middle), -1.0 * frame.x, up, half_x, half_z, 0, material, colour, classification);
    rectangle(frame.at(half_x, 0, middle), frame.y, up, half_y, half_z, gable, material, colour, classification);
    rectangle(frame.at(-half_x, 0, middle), -1.0 * frame.y, up, half_y, half_z, gable, material, colour,
              classification);
}

void Construction::house(const Frame& frame, double half_x, double half_y, double eaves, double ridge, Random& random)
{
    static const Colour wall_colours[] = {{168, 84, 62},   {152, 72, 54},   {226, 214, 188},
                                          {214, 196, 160}, {232, 230, 222}, {190, 206, 210}};
    static const Colour roof_colours[] = {{164, 78, 54}, {142, 66, 50}, {96, 92, 92}, {118, 84, 66}};
    const int paint = random.below(6);
    walls(frame, half_x, half_y, 1.0, eaves, ridge - eaves, paint < 2 ? Material::brick : Material::plaster,
          wall_colours[paint], class_building);

    const Colour& roof = roof_colours[random.below(4)];
    const double slope = std::sqrt(half_y * half_y + (ridge - eaves) * (ridge - eaves));
    const double overhang = 0.35;
    for (const double way : {-1.0, 1.0}) {
        const Vec3d down = (1 / slope) * (half_y * way * frame.y - (ridge - eaves) * up);
        const Vec3d top = frame.at(0, 0, ridge + 0.02);
        const double half_length = 0.5 * (slope + overhang);
        rectangle(top + half_length * down, way * frame.x, -1.0 * down, half_x + overhang, half_length, 0,
                  Material::tiles, roof, class_building);
    }
}

void Construction::hall(const Frame& frame, double half_x, double half_y, double height, Random& random)
{
    static const Colour colours[] = {{176, 188, 196}, {196, 190, 176}, {112, 140, 164}, {170, 94, 70}};
    const int paint = random.below(4);
    walls(frame, half_x, half_y, 1.0, height, 0, paint == 3 ? Material::brick : Material::cladding, colours[paint],
          class_building);
    rectangle(frame.at(0, 0, height), frame.x, frame.y, half_x, half_y, 0, Material::flat_roof, {132, 130, 126},
              class_building);
    // Ducts on the roof.
    const Colour steel{186, 190, 194};
    cylinder(frame.at(-0.8 * half_x, 0.45 * half_y, height + 0.5), frame.at(0.8 * half_x, 0.45 * half_y, height + 0.5),
             0.35, Material::metal, steel);
    cylinder(frame.at(-0.5 * half_x, -0.5 * half_y, height), frame.at(-0.5 * half_x, -0.5 * half_y, height + 2.2), 0.45,
             Material::metal, steel);
    disc(frame.at(-0.5 * half_x, -0.5 * half_y, height + 2.2), 0.45, Material::metal, {150, 152, 156});
}

void Construction::slab(const Frame& frame, double half_x, double half_y)
{
    const Colour grey{178, 176, 168};
    walls(frame, half_x, half_y, 1.2, 0, 0, Material::concrete, grey, class_paved);
    rectangle(frame.at(0, 0, 0), frame.x, frame.y, half_x, half_y, 0, Material::concrete, grey, class_paved);
}

}  // namespace pcm::scene
