// What a ray sees of a scene: colour, and which thing it is.
#pragma once

#include "bench/pictures/scenes/scenes.h"

#include "pcm/generate/ray_cast.h"

#include <cstdint>
#include <optional>

namespace pcm::bench {

using Rgb = std::array<std::uint8_t, 3>;

// What is asked of a picture depends on it: a surface is closed, leaves have gaps, what is thin has no inside.
enum class Kind : std::uint8_t { surface = 1, leaves = 2, thin = 3 };

struct Sight {
    Vec3d place{}, normal{};  // unit, towards the eye; of leaves and thin things it says nothing
    double distance = 0;
    scene::Colour colour{};  // 0 to 255
    Rgb label{};             // a colour of the thing's own
    Kind kind = Kind::surface;
    bool scattered = false;  // leaves without shapes in the site: whether a scanner saw it is not known
};

// Immutable after construction: threads may look concurrently. The scene must outlive it.
class Eye {
public:
    explicit Eye(const Scene& scene) : scene_(scene), caster_(scene.site) {}

    // The first thing along a ray; none in the sky. `direction` has unit length; `key` seeds what is random: the grain
    // of a surface, of which the colour is the mean of `grains`, and the depth at which a ray meets a leaf of the
    // generated site's crowns.
    std::optional<Sight> look(const Vec3d& from, const Vec3d& direction, std::uint64_t key, int grains = 1) const;
    // Whether one of the scene's scanners has this place in its window and nothing before it, and does not see the
    // surface at so sharp an angle that lines of the scan are far apart on it.
    bool was_scanned(const Sight& sight) const;

private:
    bool sees(const Scanner& scanner, const Sight& sight) const;

    const Scene& scene_;
    scene::RayCaster caster_;
};

}  // namespace pcm::bench
