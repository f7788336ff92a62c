// Scenes whose true pictures are known: surfaces that rays can be cast at, the scanners that saw them, and views.
// Everything follows from the name and the seed.
#pragma once

#include "pcm/generate/determinism.h"
#include "pcm/generate/site.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm::bench {

// Where the clouds lie: map coordinates of the scene's corner. Everything else here is in metres from that corner.
inline constexpr Vec3d scene_origin{500000, 4800000, 100};

// A laser scanner on a tripod, or one that flies along a line and scans across it.
struct Scanner {
    Vec3d from{}, to{};  // equal: a tripod
    double share = 1;    // share of the cloud's points, relative to the other scanners
    // Tripod: window of azimuths (counter-clockwise from the x axis) and elevations, degrees. Flight: the swath's half
    // angle is `highest`, and the other three are not used.
    double left = -180, right = 180, lowest = -60, highest = 60;

    bool flies() const { return from != to; }
};

struct View {
    std::string name;
    Vec3d eye{}, target{};
    double angle = 45;  // vertical, degrees
};

struct Scene {
    std::string name;
    scene::Site site;
    std::vector<Scanner> scanners;
    std::vector<View> views;
};

// Site: the one of `pcmlab generate`. Town: houses along a street. Interior: a furnished room. Forest: trunks, branches
// and leaves. Mast: a lattice tower, wires, poles.
Scene make_site_scene(std::uint64_t seed);
Scene make_town(std::uint64_t seed);
Scene make_interior(std::uint64_t seed);
Scene make_forest(std::uint64_t seed);
Scene make_mast(std::uint64_t seed);

struct SceneRow {
    const char* name;
    Scene (*make)(std::uint64_t seed);
};
inline constexpr std::array<SceneRow, 5> all_scenes{{{"site", make_site_scene},
                                                     {"town", make_town},
                                                     {"interior", make_interior},
                                                     {"forest", make_forest},
                                                     {"mast", make_mast}}};

// The empty scene of a seed: a square of `side` metres, without streets and blocks.
Scene empty_scene(const char* name, double side, std::uint64_t seed);

// A tree of cylinders and leaves (discs), all with the label of the tree: `height` metres of it, `leaves` in number,
// in clumps of `clump` metres radius. Appends to the site.
struct TreeDesign {
    double height = 11, clump = 1.1, leaf = 0.065;
    int clumps = 8, leaves = 1500;
    scene::Colour green{86, 124, 52};
};
void plant(scene::Site& site, const Vec3d& foot, const TreeDesign& design, std::uint16_t label, scene::Random& random);

// A cylinder with a label of its own choice; segments of wires and parts of trees share one.
void add_cylinder(scene::Site& site, const Vec3d& from, const Vec3d& to, double radius, scene::Material material,
                  const scene::Colour& colour, std::uint16_t label);

}  // namespace pcm::bench
