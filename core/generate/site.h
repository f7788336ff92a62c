// The generated site: shapes, ground and scanner stations, in metres from its south-west corner.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/vector.h"
#include "pcm/generate/ground.h"
#include "pcm/generate/scene.h"
#include "pcm/generate/shape.h"

#include <cstdint>
#include <vector>

namespace pcm::scene {

// By one rounded reciprocal: the bytes of generated clouds depend on it.
inline Vec3d unit(const Vec3d& a) { return (1 / std::sqrt(dot(a, a))) * a; }

struct Site {
    double side = 0;    // metres
    double block = 0;   // distance of parallel streets
    double street = 0;  // half the width of a street
    std::uint64_t seed = 0;
    Ground ground;
    std::vector<Shape> shapes;
    std::vector<Vec3d> stations;             // positions of the scanner's head
    std::vector<ScenePrimitive> primitives;  // primitives[id - 1], in metres from the corner
};

Site make_site(double side, std::uint64_t seed);

}  // namespace pcm::scene
