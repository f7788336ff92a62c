// A lattice tower with crossarms and wires, wooden poles and a lamp post on a meadow.
#include "bench/pictures/scenes/scenes.h"

#include "pcm/generate/construction.h"

#include <cmath>

namespace pcm::bench {

using namespace scene;

namespace {

constexpr Colour steel{150, 156, 164}, wood{126, 104, 82}, copper{176, 142, 96};

// Half the tower's width at a height.
double half_width(double height) { return 1.6 - 1.2 * height / 27; }

void lattice(Site& site, const Vec3d& foot, std::uint16_t label)
{
    const auto corner = [&](int side, double height) {
        const double w = half_width(height);
        return foot + Vec3d{(side == 0 || side == 3 ? -1 : 1) * w, (side < 2 ? -1 : 1) * w, height};
    };
    constexpr double panel = 2.25;
    for (int level = 0; level < 12; ++level)
        for (int side = 0; side < 4; ++side) {
            const int next = (side + 1) % 4;
            const double low = panel * level, high = low + panel;
            add_cylinder(site, corner(side, low), corner(side, high), 0.06, Material::paint, steel, label);
            add_cylinder(site, corner(side, low), corner(next, high), 0.025, Material::paint, steel, label);
            add_cylinder(site, corner(next, low), corner(side, high), 0.025, Material::paint, steel, label);
            add_cylinder(site, corner(side, high), corner(next, high), 0.03, Material::paint, steel, label);
        }
}

// A wire that hangs `sag` metres through in the middle.
void wire(Site& site, const Vec3d& from, const Vec3d& to, double sag, std::uint16_t label)
{
    constexpr int parts = 16;
    const auto at = [&](int i) {
        const double t = static_cast<double>(i) / parts;
        return from + t * (to - from) - 4 * sag * t * (1 - t) * up;
    };
    for (int i = 0; i < parts; ++i) add_cylinder(site, at(i), at(i + 1), 0.014, Material::paint, copper, label);
}

}  // namespace

Scene make_mast(std::uint64_t seed)
{
    Scene scene = empty_scene("mast", 80, seed);
    Site& site = scene.site;
    site.ground = Ground(seed);
    const auto at = [&](double x, double y, double over) { return Vec3d{x, y, site.ground.height(x, y) + over}; };
    const Vec3d foot = at(40, 40, 0);
    lattice(site, foot, 1);
    std::uint16_t label = 2;
    for (const double height : {17.0, 21.0, 25.0}) {
        const double half = 4.6 - 0.12 * height;
        for (const double rise : {0.0, 0.7})
            add_cylinder(site, foot + Vec3d{-half * (1 - rise), 0, height + rise},
                         foot + Vec3d{half * (1 - rise), 0, height + rise}, 0.05, Material::paint, steel, 1);
        for (const double side : {-half, half})
            for (const double end : {2.0, 78.0})
                wire(site, foot + Vec3d{side, 0, height - 0.3}, at(40 + side, end, height - 1), 1.1, label++);
    }
    const std::array<Vec3d, 3> poles{at(26, 31, 0), at(27, 46, 0), at(28, 61, 0)};
    for (const Vec3d& pole : poles) {
        add_cylinder(site, pole - 0.3 * up, pole + 9 * up, 0.13, Material::bark, wood, label++);
        add_cylinder(site, pole + Vec3d{-0.7, 0, 8.6}, pole + Vec3d{0.7, 0, 8.6}, 0.05, Material::bark, wood, label++);
    }
    for (std::size_t i = 0; i + 1 < poles.size(); ++i)
        for (const double side : {-0.6, 0.0, 0.6})
            wire(site, poles[i] + Vec3d{side, 0, 8.7}, poles[i + 1] + Vec3d{side, 0, 8.7}, 0.4, label++);
    const Vec3d lamp = at(46, 27, 0);
    add_cylinder(site, lamp, lamp + 6 * up, 0.05, Material::paint, steel, label);
    add_cylinder(site, lamp + 6 * up, lamp + Vec3d{-1.2, 0, 6.3}, 0.035, Material::paint, steel, label);
    const auto tripod = [&](double x, double y, double middle, double share) {
        scene.scanners.push_back({at(x, y, 1.8), at(x, y, 1.8), share, middle - 50, middle + 50, -35, 65});
    };
    tripod(38, 18, 90, 1);
    tripod(55, 22, 125, 1);
    tripod(52, 58, -120, 0.6);
    scene.views = {{"mast", at(43, 13.5, 1.7), at(38.5, 40, 10.5), 55}};
    return scene;
}

}  // namespace pcm::bench
