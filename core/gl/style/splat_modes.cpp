#include "pcm/gl/style/splat_modes.h"

#include <cstddef>

namespace pcm {

const std::vector<SplatTraits>& splat_modes()
{
    using Mode = SplatMode;
    static const std::vector<SplatTraits> table{
        {Mode::constant, "constant", "Squares of one size", "a square of a fixed size in pixels", false, false, false,
         SplatShape::pixels, "", false, Mode::constant, Mode::constant},
        {Mode::adaptive, "adaptive", "Adaptive",
         "as large as the point's radius or, where it has none, as far as its neighbours are, so that surfaces are "
         "closed; a square while the view moves, round at rest",
         true, false, false, SplatShape::sphere, "ADAPTIVE", false, Mode::constant, Mode::adaptive},
        // In an orthographic view the projection is exact, and the perspective mode's program draws the same.
        {Mode::affine, "affine", "Discs, affine",
         "its disc (radius and normal), projected as if the view were parallel around its centre", true, true, false,
         SplatShape::disc, "AFFINE", false, Mode::adaptive, Mode::perspective},
        {Mode::perspective, "perspective", "Discs, perspective accurate", "the disc exactly, with its depth", true,
         true, false, SplatShape::disc, "DISC", true, Mode::adaptive, Mode::perspective},
        {Mode::fitted, "fitted", "Fitted",
         "what its surroundings say: on a surface a disc in it, which closes it, on a wire a thin one along it, among "
         "leaves a small round one",
         true, false, true, SplatShape::ellipse, "FITTED", false, Mode::adaptive, Mode::fitted},
    };
    return table;
}

const SplatTraits& traits_of(SplatMode mode) { return splat_modes()[static_cast<std::size_t>(mode)]; }

SplatMode drawable_mode(SplatMode mode, bool has_radius, bool has_normal, bool has_shape)
{
    for (;;) {
        const SplatTraits& traits = traits_of(mode);
        if ((has_radius || !traits.reads_radius) && (has_normal || !traits.reads_normal) &&
            (has_shape || !traits.reads_shape))
            return mode;
        mode = traits.when_absent;
    }
}

}  // namespace pcm
