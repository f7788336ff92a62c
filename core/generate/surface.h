// The look of the site's surfaces: colour (brick courses, windows, road markings) and reflectivity.
#pragma once

#include "pcm/generate/determinism.h"
#include "pcm/generate/site.h"

namespace pcm::scene {

struct Look {
    Colour colour{};          // 0..255
    double reflectivity = 0;  // 0..1, of the laser
    std::uint8_t classification = 0;
};

// `shape` is null on the ground. `point` in metres from the site's corner; `random` adds the grain.
Look look_at(const Site& site, const Shape* shape, const Vec3d& point, const Vec3d& normal, Random& random);

}  // namespace pcm::scene
