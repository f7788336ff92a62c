#include "pcm/gl/colour_modes.h"

#include "pcm/gl/chunk_look.h"
#include "pcm/gl/splat_style.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcm {
namespace {

using Colour = std::array<float, 3>;

constexpr std::array<Colour, 5> ramp{{{0.267f, 0.005f, 0.329f},
                                      {0.230f, 0.322f, 0.546f},
                                      {0.128f, 0.567f, 0.551f},
                                      {0.369f, 0.789f, 0.383f},
                                      {0.993f, 0.906f, 0.144f}}};

Colour colour_of_level(const CloudStyle&, const ChunkLook& look, unsigned levels)
{
    return ramp_colour(look.level / std::max(1.0f, static_cast<float>(levels) - 1));
}

// Half a pixel is at the ramp's beginning, 64 pixels at its end.
Colour colour_of_error(const CloudStyle&, const ChunkLook& look, unsigned)
{
    return ramp_colour((std::log2(std::max(look.error_px, 0.5f)) + 1) / 7);
}

Colour uniform_colour(const CloudStyle& style, const ChunkLook&, unsigned) { return style.uniform_colour; }

}  // namespace

const std::vector<ColourTraits>& colour_modes()
{
    using Mode = ColourMode;
    using Source = ColourSource;
    static const std::vector<ColourTraits> table{
        {Mode::rgb, "rgb", "RGB", "its own colour", Colouring::vertex, Source::rgb, "colours", Mode::intensity, nullptr,
         false},
        {Mode::intensity, "intensity", "Intensity", "its intensity", Colouring::vertex, Source::intensity, "intensity",
         Mode::height, nullptr, false},
        {Mode::height, "height", "Height", "height (z, over the whole cloud)", Colouring::height, Source::none, "",
         Mode::height, nullptr, false},
        {Mode::classification, "classification", "Classification", "its class", Colouring::vertex,
         Source::classification, "classes", Mode::height, nullptr, false},
        {Mode::level, "level", "Level", "how coarse the level of detail of its chunk is", Colouring::chunk,
         Source::none, "", Mode::level, &colour_of_level, false},
        {Mode::error, "error", "Error", "how far apart points are on the screen there", Colouring::chunk, Source::none,
         "", Mode::error, &colour_of_error, true},
        {Mode::uniform, "uniform", "Uniform", "nothing", Colouring::chunk, Source::none, "", Mode::uniform,
         &uniform_colour, false},
    };
    return table;
}

const ColourTraits& traits_of(ColourMode mode) { return colour_modes()[static_cast<std::size_t>(mode)]; }

std::array<float, 3> ramp_colour(float t)
{
    const float s = std::clamp(t, 0.0f, 1.0f) * 4;
    const auto first = static_cast<std::size_t>(std::min(s, 3.0f));
    const float part = s - static_cast<float>(first);
    Colour colour{};
    for (std::size_t c = 0; c < 3; ++c) colour[c] = ramp[first][c] + part * (ramp[first + 1][c] - ramp[first][c]);
    return colour;
}

}  // namespace pcm
