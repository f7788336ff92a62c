#include "pcm/generate/site.h"

#include "pcm/generate/determinism.h"

#include <algorithm>
#include <cmath>

namespace pcm::scene {
namespace {

constexpr double least_block = 30.0;
constexpr int most_blocks = 48;  // a side
constexpr std::size_t most_primitives = 60000;
constexpr double scanner_height = 1.8;
constexpr double mast_height = 14.0;  // of the scanner where roofs and tanks are to be seen from above
constexpr double half_street = 3.5;
constexpr double sidewalk = 1.5;

constexpr std::uint8_t class_vegetation = 5;
constexpr std::uint8_t class_building = 6;
constexpr std::uint8_t class_paved = 11;
constexpr std::uint8_t class_plant = 19;

const Vec3d up{0, 0, 1};

// Where a group of things stands: its own x and y axis, and the height of its foot.
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

class Architect {
public:
    Architect(double side, std::uint64_t seed);
    Site build();

private:
    bool room_for(std::size_t primitives) const { return site_.primitives.size() + primitives <= most_primitives; }
    std::uint16_t new_primitive(const ScenePrimitive& primitive);

    void rectangle(const Vec3d& centre, const Vec3d& u, const Vec3d& v, double half_u, double half_v, double gable,
                   Material material, const Colour& colour, std::uint8_t classification);
    void disc(const Vec3d& centre, double radius, Material material, const Colour& colour);
    void cylinder(const Vec3d& from, const Vec3d& to, double radius, Material material, const Colour& colour);
    void dome(const Vec3d& rim_centre, double rim_radius, double rise, const Colour& colour);
    void sphere(const Vec3d& centre, double radius, const Colour& colour);
    void tree(double x, double y, double height, Random& random);

    void walls(const Frame& frame, double half_x, double half_y, double below, double height, double gable,
               Material material, const Colour& colour, std::uint8_t classification);
    void house(const Frame& frame, double half_x, double half_y, double eaves, double ridge, Random& random);
    void hall(const Frame& frame, double half_x, double half_y, double height, Random& random);
    void slab(const Frame& frame, double half_x, double half_y);

    void houses(double x, double y, double half, Random& random);
    void works(double x, double y, double half, Random& random);
    void tank_farm(double x, double y, double half, Random& random);
    void pipe_rack(double x, double y, double half, Random& random);
    void sphere_tanks(double x, double y, double half, Random& random);
    void park(double x, double y, double half, Random& random);
    void street_trees();
    void stations();

    double ground(double x, double y) const { return site_.ground.height(x, y); }
    int blocks_ = 1;
    Site site_;
    std::vector<Vec3d> inner_stations_;  // on roofs, between tanks, in yards
};

Architect::Architect(double side, std::uint64_t seed)
{
    site_.side = side;
    site_.seed = seed;
    blocks_ = std::clamp(static_cast<int>(side / least_block), 1, most_blocks);
    site_.block = side / blocks_;
    site_.street = half_street;
    site_.ground = Ground(seed);
}

std::uint16_t Architect::new_primitive(const ScenePrimitive& primitive)
{
    site_.primitives.push_back(primitive);
    site_.primitives.back().id = static_cast<std::uint16_t>(site_.primitives.size());
    return site_.primitives.back().id;
}

void Architect::rectangle(const Vec3d& centre, const Vec3d& u, const Vec3d& v, double half_u, double half_v,
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

void Architect::disc(const Vec3d& centre, double radius, Material material, const Colour& colour)
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

void Architect::cylinder(const Vec3d& from, const Vec3d& to, double radius, Material material, const Colour& colour)
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
    if (material != Material::bark)  // trunks are not part of the truth
        s.id = new_primitive({ScenePrimitive::Kind::cylinder, 0, s.centre, s.n, radius, 0});
    site_.shapes.push_back(s);
}

// The part of a sphere above its circle of `rim_radius`; `rise` is its height.
void Architect::dome(const Vec3d& rim_centre, double rim_radius, double rise, const Colour& colour)
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

void Architect::sphere(const Vec3d& centre, double radius, const Colour& colour)
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

void Architect::tree(double x, double y, double height, Random& random)
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
    if (random.chance(0.3)) {  // a conifer: ever smaller tiers
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

// Four walls from `below` under the foot to `height` over it; a gable stands on the two that face along x.
void Architect::walls(const Frame& frame, double half_x, double half_y, double below, double height, double gable,
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

void Architect::house(const Frame& frame, double half_x, double half_y, double eaves, double ridge, Random& random)
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

void Architect::hall(const Frame& frame, double half_x, double half_y, double height, Random& random)
{
    static const Colour colours[] = {{176, 188, 196}, {196, 190, 176}, {112, 140, 164}, {170, 94, 70}};
    const int paint = random.below(4);
    walls(frame, half_x, half_y, 1.0, height, 0, paint == 3 ? Material::brick : Material::cladding, colours[paint],
          class_building);
    rectangle(frame.at(0, 0, height), frame.x, frame.y, half_x, half_y, 0, Material::flat_roof, {132, 130, 126},
              class_building);
    // Ducts along the roof, and a scanner that sees them.
    const Colour steel{186, 190, 194};
    cylinder(frame.at(-0.8 * half_x, 0.45 * half_y, height + 0.5), frame.at(0.8 * half_x, 0.45 * half_y, height + 0.5),
             0.35, Material::metal, steel);
    cylinder(frame.at(-0.5 * half_x, -0.5 * half_y, height), frame.at(-0.5 * half_x, -0.5 * half_y, height + 2.2), 0.45,
             Material::metal, steel);
    disc(frame.at(-0.5 * half_x, -0.5 * half_y, height + 2.2), 0.45, Material::metal, {150, 152, 156});
    inner_stations_.push_back(frame.at(0.3 * half_x, -0.2 * half_y, height + scanner_height));
}

// A concrete plate that stands a little out of the ground.
void Architect::slab(const Frame& frame, double half_x, double half_y)
{
    const Colour grey{178, 176, 168};
    walls(frame, half_x, half_y, 1.2, 0, 0, Material::concrete, grey, class_paved);
    rectangle(frame.at(0, 0, 0), frame.x, frame.y, half_x, half_y, 0, Material::concrete, grey, class_paved);
}

void Architect::houses(double x, double y, double half, Random& random)
{
    const int rows = half >= 11 ? 2 : 1;
    const double cell = half / rows;  // half the side of a garden
    if (rows == 2) inner_stations_.push_back({x, y, ground(x, y) + scanner_height});
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < rows; ++j) {
            if (!room_for(6)) return;
            const double cx = x - half + (2 * i + 1) * cell;
            const double cy = y - half + (2 * j + 1) * cell;
            const double half_x = cell * random.between(0.55, 0.68);
            const double half_y = cell * random.between(0.42, 0.55);
            const double eaves = (random.chance(0.5) ? 3.0 : 5.6) + 0.1 * cell;
            double turns = random.between(-0.02, 0.02);
            if (random.chance(0.5)) turns += 0.25;
            const Frame frame({cx, cy, ground(cx, cy)}, turns);
            house(frame, half_x, half_y, eaves, eaves + half_y * random.between(0.55, 0.9), random);
            if (random.chance(0.7)) tree(cx + 0.85 * cell, cy + 0.85 * cell, random.between(4, 6.5), random);
        }
}

void Architect::works(double x, double y, double half, Random& random)
{
    if (!room_for(12)) return;
    const double turns = random.between(-0.008, 0.008);
    const Frame frame({x, y, ground(x, y)}, turns);
    const double height = random.between(5.5, 8.5) + 0.08 * half;
    hall(frame, 0.88 * half, 0.62 * half, height, random);
    const double stack = height + random.between(4, 10);
    const Vec3d foot = frame.at(0.6 * half, 0.84 * half, -1);
    cylinder(foot, foot + (stack + 1) * up, 0.7, Material::brick, {158, 88, 68});
    cylinder(frame.at(-0.8 * half, -0.7 * half, 0.6), frame.at(0.8 * half, -0.7 * half, 0.6), 0.16, Material::paint,
             {206, 176, 52});
}

void Architect::tank_farm(double x, double y, double half, Random& random)
{
    if (!room_for(22)) return;
    // The plate's upper side must be over the ground at all its corners.
    double top = ground(x, y);
    for (const double a : {-half, 0.0, half})
        for (const double b : {-half, 0.0, half}) top = std::max(top, ground(x + a, y + b));
    const Frame frame({x, y, top + 0.1}, 0);
    slab(frame, half, half);
    static const Colour colours[] = {{228, 228, 222}, {206, 210, 212}, {214, 204, 178}, {176, 196, 204}};
    const double cell = 0.5 * half;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            const double a = (2 * i - 1) * cell, b = (2 * j - 1) * cell;
            const double radius = cell * random.between(0.55, 0.72);
            const double height = radius * random.between(0.9, 1.6);
            const Colour& colour = colours[random.below(4)];
            const Vec3d foot = frame.at(a, b, 0);
            cylinder(foot, foot + height * up, radius, Material::paint, colour);
            if (i == j)
                dome(foot + height * up, radius, radius * random.between(0.3, 0.6), colour);
            else
                disc(foot + height * up, radius, Material::paint, colour);
            // From the tank's shell to the collecting pipe in the middle.
            const double way = a > 0 ? -1 : 1;
            cylinder(frame.at(a + way * radius, b, 0.5), frame.at(0, b, 0.5), 0.12, Material::metal, {170, 174, 178});
        }
    inner_stations_.push_back(frame.at(0.1 * half, 0.1 * half, scanner_height));
    cylinder(frame.at(0, -0.97 * half, 0.5), frame.at(0, 0.97 * half, 0.5), 0.2, Material::paint, {62, 110, 160});
    cylinder(frame.at(0, -0.97 * half, 0), frame.at(0, -0.97 * half, 3.2), 0.2, Material::paint, {62, 110, 160});
}

void Architect::pipe_rack(double x, double y, double half, Random& random)
{
    if (!room_for(24)) return;
    static const Colour colours[] = {{196, 200, 204}, {214, 182, 60}, {178, 62, 48}, {66, 116, 166}, {88, 140, 92}};
    const Frame frame({x, y, ground(x, y)}, random.chance(0.5) ? 0.25 : 0.0);
    const Colour frame_colour{120, 124, 128};
    for (int i = 0; i < 4; ++i)
        for (const double side : {-1.0, 1.0}) {
            const double a = (-0.9 + 0.6 * i) * half;
            cylinder(frame.at(a, side * 2.4, -1), frame.at(a, side * 2.4, 5.4), 0.13, Material::metal, frame_colour);
        }
    double b = -1.9;
    for (int pipe = 0; pipe < 6; ++pipe) {
        const double radius = random.between(0.09, 0.3);
        const double height = pipe % 2 ? 5.4 : 3.8;
        const double start = -random.between(0.82, 0.98) * half, end = random.between(0.82, 0.98) * half;
        const Colour& colour = colours[random.below(5)];
        cylinder(frame.at(start, b, height), frame.at(end, b, height), radius, Material::metal, colour);
        if (pipe % 2 == 0)  // goes down at one end
            cylinder(frame.at(end, b, height), frame.at(end, b, -1), radius, Material::metal, colour);
        b += 0.76;
    }
    // Vessels beside the rack.
    for (const double side : {-1.0, 1.0}) {
        const double radius = random.between(0.9, 1.4);
        const Vec3d foot = frame.at(side * 0.4 * half, side * 0.62 * half, -1);
        const double height = random.between(5, 8);
        cylinder(foot, foot + height * up, radius, Material::paint, {210, 212, 210});
        dome(foot + height * up, radius, 0.4 * radius, {210, 212, 210});
    }
}

void Architect::sphere_tanks(double x, double y, double half, Random& random)
{
    if (!room_for(24)) return;
    const double turns = random.chance(0.5) ? 0.25 : 0.0;
    const Frame frame({x, y, ground(x, y)}, turns);
    for (const double side : {-1.0, 1.0}) {
        const double radius = std::min(9.0, half * random.between(0.3, 0.36));
        const double clearance = 1.2;
        const Vec3d centre = frame.at(side * 0.48 * half, side * 0.25 * half, radius + clearance);
        sphere(centre, radius, {224, 224, 216});
        for (int leg = 0; leg < 6; ++leg) {
            double s, c;
            sine_cosine(leg / 6.0, s, c);
            const Vec3d at = centre + 0.93 * radius * Vec3d{c, s, 0};
            cylinder(at - (radius + clearance + 1) * up, at, 0.14, Material::paint, {190, 192, 188});
        }
    }
    const double run = 0.75 * half;
    cylinder(frame.at(-run, -run, 0.45), frame.at(run, -run, 0.45), 0.18, Material::paint, {178, 62, 48});
}

void Architect::park(double x, double y, double half, Random& random)
{
    const int count = 7 + random.below(6);
    for (int i = 0; i < count; ++i) {
        // In statements of their own: in which order the arguments of a call are evaluated is up to the compiler.
        const double east = random.between(-0.85, 0.85);
        const double north = random.between(-0.85, 0.85);
        const double height = random.between(4.5, 10);
        tree(x + half * east, y + half * north, height, random);
    }
}

void Architect::street_trees()
{
    Random random(hash(site_.seed, 0x7265));
    const double from_middle = half_street + 0.6 * sidewalk;
    for (int street = 1; street < blocks_; ++street)
        for (double along = half_street + 6; along < site_.side - 4; along += 9) {
            const double in_block = along - site_.block * std::floor(along / site_.block);
            if (in_block < half_street + 4 || in_block > site_.block - half_street - 4) continue;  // free crossings
            if (random.chance(0.3)) tree(street * site_.block + from_middle, along, random.between(4, 5.5), random);
            if (random.chance(0.3)) tree(along, street * site_.block - from_middle, random.between(4, 5.5), random);
        }
}

void Architect::stations()
{
    Random random(hash(site_.seed, 0x7374));
    const double margin = 2.0;
    const auto place = [&](double x, double y, double height) {
        const double jitter = 0.6 * half_street;
        const double px = std::clamp(x + random.between(-jitter, jitter), margin, site_.side - margin);
        const double py = std::clamp(y + random.between(-jitter, jitter), margin, site_.side - margin);
        site_.stations.push_back({px, py, ground(px, py) + height});
    };
    const bool between = site_.block > 45;  // wide blocks hide too much from the crossings alone
    for (int i = 0; i <= blocks_; ++i)
        for (int j = 0; j <= blocks_; ++j) {
            const double x = i * site_.block, y = j * site_.block;
            place(x, y, scanner_height);
            if (between && i < blocks_) place(x + 0.5 * site_.block, y, scanner_height);
            if (between && j < blocks_) place(x, y + 0.5 * site_.block, scanner_height);
            if ((i + j) % 2 == 1) place(x, y, mast_height);
        }
    site_.stations.insert(site_.stations.end(), inner_stations_.begin(), inner_stations_.end());
}

Site Architect::build()
{
    const double half = 0.5 * site_.block - half_street - sidewalk;
    for (int i = 0; i < blocks_; ++i)
        for (int j = 0; j < blocks_; ++j) {
            Random random(hash(site_.seed, static_cast<std::uint64_t>(i) * 4096 + static_cast<std::uint64_t>(j)));
            const double x = (i + 0.5) * site_.block, y = (j + 0.5) * site_.block;
            if (half < 5) continue;
            // The first four blocks show something of everything; beyond, town in the west and industry in the east.
            const bool town = i + 0.5 < 0.45 * blocks_;
            int kind = town ? (random.chance(0.7) ? 0 : random.chance(0.5) ? 5 : 1) : 1 + random.below(4);
            if (!town && random.chance(0.08)) kind = 5;
            if (i < 2 && j < 2) kind = (i == 0) ? (j == 0 ? 0 : 1) : (j == 0 ? 2 : 3);
            switch (kind) {
                case 0:
                    houses(x, y, half, random);
                    break;
                case 1:
                    works(x, y, half, random);
                    break;
                case 2:
                    tank_farm(x, y, half, random);
                    break;
                case 3:
                    pipe_rack(x, y, half, random);
                    break;
                case 4:
                    sphere_tanks(x, y, half, random);
                    break;
                default:
                    park(x, y, half, random);
                    break;
            }
            // Small sites have no block to spare for spheres.
            if (blocks_ <= 2 && kind == 3 && room_for(1)) {
                const double radius = std::min(2.2, 0.2 * half), px = x - 0.66 * half, py = y + 0.62 * half;
                sphere({px, py, ground(px, py) + 0.9 * radius}, radius, {224, 224, 216});
            }
        }
    street_trees();
    stations();
    return std::move(site_);
}

}  // namespace

Box3d Shape::box() const
{
    Box3d box;
    // A dome is no wider than its rim where that is above the sphere's middle.
    const double rim = lowest - centre[2];
    const double girth = rim > 0 ? std::sqrt(std::max(0.0, radius * radius - rim * rim)) : radius;
    for (std::size_t a = 0; a < 3; ++a) {
        double below = 0, above = 0;
        switch (kind) {
            case Kind::rectangle:
                below = above = std::abs(u[a]) * half_u + std::abs(v[a]) * half_v;
                above += std::max(0.0, v[a] * gable);
                below += std::max(0.0, -v[a] * gable);
                break;
            case Kind::disc:
                below = above = radius * std::sqrt(std::max(0.0, 1 - n[a] * n[a]));
                break;
            case Kind::cylinder:
                below = above = std::abs(n[a]) * half_v + radius * std::sqrt(std::max(0.0, 1 - n[a] * n[a]));
                break;
            case Kind::sphere:
                below = above = a == 2 ? radius : girth;
                break;
            case Kind::crown:
                below = above = radius;
                break;
        }
        box.min[a] = centre[a] - below - 1e-9;
        box.max[a] = centre[a] + above + 1e-9;
    }
    box.min[2] = std::max(box.min[2], lowest);
    return box;
}

Ground::Ground(std::uint64_t seed)
{
    constexpr double tau = 6.283185307179586476925;
    struct {
        double amplitude, length;
    } const design[] = {{6.0, 1700}, {0.8, 190}, {0.2, 67}, {0.03, 19}};
    Random random(hash(seed, 0x6772));
    for (std::size_t i = 0; i < waves_.size(); ++i) {
        double sine, cosine;
        sine_cosine(random.unit(), sine, cosine);
        waves_[i] = {design[i].amplitude, cosine / design[i].length, sine / design[i].length, random.unit()};
        const double wave_number = tau / design[i].length;
        steepest_ += design[i].amplitude * wave_number;
        most_curved_ += design[i].amplitude * wave_number * wave_number;
    }
}

double Ground::height(double x, double y) const
{
    double slope_x, slope_y;
    return height(x, y, slope_x, slope_y);
}

double Ground::height(double x, double y, double& slope_x, double& slope_y) const
{
    constexpr double tau = 6.283185307179586476925;
    double sum = 0;
    slope_x = slope_y = 0;
    for (const Wave& wave : waves_) {
        double sine, cosine;
        sine_cosine(wave.x * x + wave.y * y + wave.phase, sine, cosine);
        sum += wave.amplitude * sine;
        slope_x += wave.amplitude * tau * wave.x * cosine;
        slope_y += wave.amplitude * tau * wave.y * cosine;
    }
    return sum;
}

Site make_site(double side, std::uint64_t seed) { return Architect(side, seed).build(); }

}  // namespace pcm::scene
