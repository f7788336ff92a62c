// Sub-pixel offsets of frames whose mean is a picture without stairs at edges and without shimmer. No OpenGL here.
//
// Each frame samples the scene once a pixel, elsewhere in the pixel; their mean is what a pixel sees of its own area.
// The offsets are a (0, 2)-sequence in base 2 (van der Corput's radical inverse in x, Sobol's second dimension in y;
// see Niederreiter 1992, Kollig and Keller 2002), each modulo 1 from -1/2 on: the first 2^(a + b) have exactly
// one in each cell of 2^-a by 2^-b pixels, whatever a and b. The first offset is 0, so the picture that is already
// there counts as a frame.
#pragma once

#include "pcm/view/camera.h"

#include <array>
#include <cstdint>

namespace pcm {

// Offset of frame 0, 1, ...: pixels to the right and up, from -0.5 to below 0.5; exact in double.
std::array<double, 2> pixel_offset(std::uint32_t frame);

// The same camera with the picture shifted by `pixels` to the right and up. Depth and distances are kept. Without
// an offset it is the same camera, to the bit.
Camera shifted(Camera view, const std::array<double, 2>& pixels);

}  // namespace pcm
