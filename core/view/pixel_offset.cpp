#include "pcm/view/pixel_offset.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

// The fraction of 2^32, modulo 1 from -1/2 on.
double centred(std::uint32_t fraction)
{
    return (static_cast<double>(fraction) - (fraction & 0x80000000u ? 4294967296.0 : 0.0)) / 4294967296.0;
}

// Where a tent's distribution reaches 1/2 + `even`.
double tent(double even)
{
    const double place = filter_reach * (1 - std::sqrt(std::max(0.0, 1 - 2 * std::fabs(even))));
    return even < 0 ? -place : place;
}

}  // namespace

std::array<double, 2> even_sample(std::uint32_t number)
{
    // Columns of the generator matrices: the identity, and Pascal's triangle modulo 2.
    std::uint32_t x = 0, y = 0, reversed = 0x80000000u, pascal = 0x80000000u;
    for (; number; number >>= 1) {
        if (number & 1u) {
            x ^= reversed;
            y ^= pascal;
        }
        reversed >>= 1;
        pascal ^= pascal >> 1;
    }
    return {centred(x), centred(y)};
}

std::array<double, 2> pixel_offset(std::uint32_t frame, std::uint32_t frames)
{
    if (frame == 0) return {0, 0};
    // The samples are multiples of 1 / frames from -1/2 on: these are moved to the middles of their cells.
    const double half_cell = 0.5 / static_cast<double>(std::max(frames, frame + 1));
    const std::array<double, 2> even = even_sample(frame);
    return {tent(even[0] + half_cell), tent(even[1] + half_cell)};
}

Camera shifted(Camera view, const std::array<double, 2>& pixels)
{
    if (pixels[0] == 0 && pixels[1] == 0) return view;
    // In clip space, x + shift * w.
    const std::array<double, 2> shift{2 * pixels[0] / view.width, 2 * pixels[1] / view.height};
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t r = 0; r < 2; ++r) view.projection[c * 4 + r] += shift[r] * view.projection[c * 4 + 3];
    return view;
}

}  // namespace pcm
