#include "pcm/generate/site.h"

#include "pcm/generate/construction.h"
#include "pcm/generate/determinism.h"

#include <algorithm>
#include <cmath>

namespace pcm::scene {
namespace {

constexpr double least_block = 30.0;
constexpr int most_blocks = 48;  // along each side
constexpr double scanner_height = 1.8;
constexpr double mast_height = 14.0;  // scanner height where it sees roofs and tanks from above
constexpr double half_street = 3.5;
constexpr double sidewalk = 1.5;

// Lays out the site: what stands in each block, and the stations of the scanner.
class Architect {
public:
    Architect(double side, std::uint64_t seed);
    Site build();

private:
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
    Construction construct_{site_};
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

void Architect::houses(double x, double y, double half, Random& random)
{
    const int rows = half >= 11 ? 2 : 1;
    const double cell = half / rows;  // half the side of a garden
    if (rows == 2) inner_stations_.push_back({x, y, ground(x, y) + scanner_height});
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < rows; ++j) {
            if (!construct_.room_for(6)) return;
            const double cx = x - half + (2 * i + 1) * cell;
            const double cy = y - half + (2 * j + 1) * cell;
            const double half_x = cell * random.between(0.55, 0.68);
            const double half_y = cell * random.between(0.42, 0.55);
            const double eaves = (random.chance(0.5) ? 3.0 : 5.6) + 0.1 * cell;
            double turns = random.between(-0.02, 0.02);
            if (random.chance(0.5)) turns += 0.25;
            const Frame frame({cx, cy, ground(cx, cy)}, turns);
            construct_.house(frame, half_x, half_y, eaves, eaves + half_y * random.between(0.55, 0.9), random);
            if (random.chance(0.7)) construct_.tree(cx + 0.85 * cell, cy + 0.85 * cell, random.between(4, 6.5), random);
        }
}

void Architect::works(double x, double y, double half, Random& random)
{
    if (!construct_.room_for(12)) return;
    const double turns = random.between(-0.008, 0.008);
    const Frame frame({x, y, ground(x, y)}, turns);
    const double height = random.between(5.5, 8.5) + 0.08 * half;
    const double half_x = 0.88 * half, half_y = 0.62 * half;
    construct_.hall(frame, half_x, half_y, height, random);
    inner_stations_.push_back(frame.at(0.3 * half_x, -0.2 * half_y, height + scanner_height));
    const double stack = height + random.between(4, 10);
    const Vec3d foot = frame.at(0.6 * half, 0.84 * half, -1);
    construct_.cylinder(foot, foot + (stack + 1) * up, 0.7, Material::brick, {158, 88, 68});
    construct_.cylinder(frame.at(-0.8 * half, -0.7 * half, 0.6), frame.at(0.8 * half, -0.7 * half, 0.6), 0.16,
                        Material::paint, {206, 176, 52});
}

void Architect::tank_farm(double x, double y, double half, Random& random)
{
    if (!construct_.room_for(22)) return;
    // The slab's upper side must be above the ground at all its corners.
    double top = ground(x, y);
    for (const double a : {-half, 0.0, half})
        for (const double b : {-half, 0.0, half}) top = std::max(top, ground(x + a, y + b));
    const Frame frame({x, y, top + 0.1}, 0);
    construct_.slab(frame, half, half);
    static const Colour colours[] = {{228, 228, 222}, {206, 210, 212}, {214, 204, 178}, {176, 196, 204}};
    const double cell = 0.5 * half;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            const double a = (2 * i - 1) * cell, b = (2 * j - 1) * cell;
            const double radius = cell * random.between(0.55, 0.72);
            const double height = radius * random.between(0.9, 1.6);
            const Colour& colour = colours[random.below(4)];
            const Vec3d foot = frame.at(a, b, 0);
            construct_.cylinder(foot, foot + height * up, radius, Material::paint, colour);
            if (i == j)
                construct_.dome(foot + height * up, radius, radius * random.between(0.3, 0.6), colour);
            else
                construct_.disc(foot + height * up, radius, Material::paint, colour);
            // A pipe from the tank's shell to the collecting pipe in the middle.
            const double way = a > 0 ? -1 : 1;
            construct_.cylinder(frame.at(a + way * radius, b, 0.5), frame.at(0, b, 0.5), 0.12, Material::metal,
                                {170, 174, 178});
        }
    inner_stations_.push_back(frame.at(0.1 * half, 0.1 * half, scanner_height));
    construct_.cylinder(frame.at(0, -0.97 * half, 0.5), frame.at(0, 0.97 * half, 0.5), 0.2, Material::paint,
                        {62, 110, 160});
    construct_.cylinder(frame.at(0, -0.97 * half, 0), frame.at(0, -0.97 * half, 3.2), 0.2, Material::paint,
                        {62, 110, 160});
}

void Architect::pipe_rack(double x, double y, double half, Random& random)
{
    if (!construct_.room_for(24)) return;
    static const Colour colours[] = {{196, 200, 204}, {214, 182, 60}, {178, 62, 48}, {66, 116, 166}, {88, 140, 92}};
    const Frame frame({x, y, ground(x, y)}, random.chance(0.5) ? 0.25 : 0.0);
    const Colour frame_colour{120, 124, 128};
    for (int i = 0; i < 4; ++i)
        for (const double side : {-1.0, 1.0}) {
            const double a = (-0.9 + 0.6 * i) * half;
            construct_.cylinder(frame.at(a, side * 2.4, -1), frame.at(a, side * 2.4, 5.4), 0.13, Material::metal,
                                frame_colour);
        }
    double b = -1.9;
    for (int pipe = 0; pipe < 6; ++pipe) {
        const double radius = random.between(0.09, 0.3);
        const double height = pipe % 2 ? 5.4 : 3.8;
        const double start = -random.between(0.82, 0.98) * half, end = random.between(0.82, 0.98) * half;
        const Colour& colour = colours[random.below(5)];
        construct_.cylinder(frame.at(start, b, height), frame.at(end, b, height), radius, Material::metal, colour);
        if (pipe % 2 == 0)  // a vertical end
            construct_.cylinder(frame.at(end, b, height), frame.at(end, b, -1), radius, Material::metal, colour);
        b += 0.76;
    }
    // Vessels next to the rack.
    for (const double side : {-1.0, 1.0}) {
        const double radius = random.between(0.9, 1.4);
        const Vec3d foot = frame.at(side * 0.4 * half, side * 0.62 * half, -1);
        const double height = random.between(5, 8);
        construct_.cylinder(foot, foot + height * up, radius, Material::paint, {210, 212, 210});
        construct_.dome(foot + height * up, radius, 0.4 * radius, {210, 212, 210});
    }
}

void Architect::sphere_tanks(double x, double y, double half, Random& random)
{
    if (!construct_.room_for(24)) return;
    const double turns = random.chance(0.5) ? 0.25 : 0.0;
    const Frame frame({x, y, ground(x, y)}, turns);
    for (const double side : {-1.0, 1.0}) {
        const double radius = std::min(9.0, half * random.between(0.3, 0.36));
        const double clearance = 1.2;
        const Vec3d centre = frame.at(side * 0.48 * half, side * 0.25 * half, radius + clearance);
        construct_.sphere(centre, radius, {224, 224, 216});
        for (int leg = 0; leg < 6; ++leg) {
            double s, c;
            sine_cosine(leg / 6.0, s, c);
            const Vec3d at = centre + 0.93 * radius * Vec3d{c, s, 0};
            construct_.cylinder(at - (radius + clearance + 1) * up, at, 0.14, Material::paint, {190, 192, 188});
        }
    }
    const double run = 0.75 * half;
    construct_.cylinder(frame.at(-run, -run, 0.45), frame.at(run, -run, 0.45), 0.18, Material::paint, {178, 62, 48});
}

void Architect::park(double x, double y, double half, Random& random)
{
    const int count = 7 + random.below(6);
    for (int i = 0; i < count; ++i) {
        // Separate statements: the order in which the arguments of a call are evaluated is unspecified.
        const double east = random.between(-0.85, 0.85);
        const double north = random.between(-0.85, 0.85);
        const double height = random.between(4.5, 10);
        construct_.tree(x + half * east, y + half * north, height, random);
    }
}

void Architect::street_trees()
{
    Random random(hash(site_.seed, 0x7265));
    const double from_middle = half_street + 0.6 * sidewalk;
    for (int street = 1; street < blocks_; ++street)
        for (double along = half_street + 6; along < site_.side - 4; along += 9) {
            const double in_block = along - site_.block * std::floor(along / site_.block);
            if (in_block < half_street + 4 || in_block > site_.block - half_street - 4)
                continue;  // crossings stay free
            if (random.chance(0.3))
                construct_.tree(street * site_.block + from_middle, along, random.between(4, 5.5), random);
            if (random.chance(0.3))
                construct_.tree(along, street * site_.block - from_middle, random.between(4, 5.5), random);
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
    const bool between = site_.block > 45;  // crossings alone see too little of wide blocks
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
            // The first four blocks show every kind; the others are town in the west and industry in the east.
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
            // Small sites have no block of their own for spheres.
            if (blocks_ <= 2 && kind == 3 && construct_.room_for(1)) {
                const double radius = std::min(2.2, 0.2 * half), px = x - 0.66 * half, py = y + 0.62 * half;
                construct_.sphere({px, py, ground(px, py) + 0.9 * radius}, radius, {224, 224, 216});
            }
        }
    street_trees();
    stations();
    return std::move(site_);
}

}  // namespace

Site make_site(double side, std::uint64_t seed) { return Architect(side, seed).build(); }

}  // namespace pcm::scene
