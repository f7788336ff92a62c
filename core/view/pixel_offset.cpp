#include "pcm/view/pixel_offset.h"

namespace pcm {
namespace {

// The fraction of 2^32, modulo 1 from -1/2 on.
double centred(std::uint32_t fraction)
{
    return (static_cast<double>(fraction) - (fraction & 0x80000000u ? 4294967296.0 : 0.0)) / 4294967296.0;
}

}  // namespace

std::array<double, 2> pixel_offset(std::uint32_t frame)
{
    // Columns of the generator matrices: the identity, and Pascal's triangle modulo 2.
    std::uint32_t x = 0, y = 0, reversed = 0x80000000u, pascal = 0x80000000u;
    for (; frame; frame >>= 1) {
        if (frame & 1u) {
            x ^= reversed;
            y ^= pascal;
        }
        reversed >>= 1;
        pascal ^= pascal >> 1;
    }
    return {centred(x), centred(y)};
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
