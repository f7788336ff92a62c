// Sub-pixel offsets of frames whose mean is a picture without stairs at edges and without shimmer. No OpenGL here.
//
// Each frame samples the scene once a pixel, elsewhere around its centre; their mean is the scene seen through a
// filter, whose weight is how densely the samples lie. It is a tent, `filter_reach` pixels to either side in x and in
// y: the area of a pixel alone, a box, lets through what is finer than pixels, and a turn by a part of a pixel makes
// that swim; a tent reaches into the neighbouring pixels and holds it back.
//
// The samples are even: a (0, 2)-sequence in base 2 (van der Corput's radical inverse in x, Sobol's second dimension in
// y; see Niederreiter 1992, Kollig and Keller 2002), each modulo 1 from -1/2 on, of which the first 2^(a + b) have
// exactly one in each cell of 2^-a by 2^-b, whatever a and b; through the inverse of the tent's distribution (Ernst,
// Stamminger and Greiner 2006). The first offset is 0, so the picture that is already there counts as a frame.
#pragma once

#include "pcm/view/camera.h"

#include <array>
#include <cstdint>

namespace pcm {

// The standard deviation is 0.49 pixels, about that of the Gaussian filters that renderers of films use.
inline constexpr double filter_reach = 1.2;

// Member 0, 1, ... of the sequence: two numbers from -1/2 to below 1/2; exact in double.
std::array<double, 2> even_sample(std::uint32_t number);

// Offset of frame 0, 1, ... of `frames` whose mean is wanted: pixels to the right and up, nearer to 0 than
// `filter_reach`. The mean of all is 0, nearly.
std::array<double, 2> pixel_offset(std::uint32_t frame, std::uint32_t frames);

// The same camera with the picture shifted by `pixels` to the right and up. Depth and distances are kept. Without
// an offset it is the same camera, to the bit.
Camera shifted(Camera view, const std::array<double, 2>& pixels);

}  // namespace pcm
