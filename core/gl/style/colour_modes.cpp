#include "pcm/gl/style/colour_modes.h"

#include "pcm/gl/style/chunk_look.h"
#include "pcm/gl/style/splat_style.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcm {
namespace {

using Colour = std::array<float, 3>;

Colour colour_of_level(const CloudStyle& style, const ChunkLook& look, unsigned levels)
{
    return ramp_colour(look.level / std::max(1.0f, static_cast<float>(levels) - 1), style.ramp);
}

// Half a pixel is at the ramp's beginning, 64 pixels at its end.
Colour colour_of_error(const CloudStyle& style, const ChunkLook& look, unsigned)
{
    return ramp_colour((std::log2(std::max(look.error_px, 0.5f)) + 1) / 7, style.ramp);
}

Colour uniform_colour(const CloudStyle& style, const ChunkLook&, unsigned) { return style.uniform_colour; }

}  // namespace

const std::vector<ColourTraits>& colour_modes()
{
    using Mode = ColourMode;
    using Source = ColourSource;
    static const std::vector<ColourTraits> table{
        {Mode::rgb, "rgb", "RGB", "its own colour", Colouring::vertex, Source::rgb, "colours", Mode::classification,
         nullptr, false},
        {Mode::intensity, "intensity", "Intensity", "its intensity", Colouring::value, Source::intensity, "intensity",
         Mode::height, nullptr, false},
        {Mode::height, "height", "Height", "height (z)", Colouring::height, Source::none, "", Mode::height, nullptr,
         false},
        {Mode::classification, "classification", "Classification", "its class", Colouring::vertex,
         Source::classification, "classes", Mode::height_intensity, nullptr, false},
        {Mode::level, "level", "Level", "how coarse the level of detail of its chunk is", Colouring::chunk,
         Source::none, "", Mode::level, &colour_of_level, false},
        {Mode::error, "error", "Error", "how far apart points are on the screen there", Colouring::chunk, Source::none,
         "", Mode::error, &colour_of_error, true},
        {Mode::uniform, "uniform", "Uniform", "nothing", Colouring::chunk, Source::none, "", Mode::uniform,
         &uniform_colour, false},
        {Mode::attribute, "attribute", "Attribute", "an attribute that you name", Colouring::value, Source::attribute,
         "attribute", Mode::height, nullptr, false},
        {Mode::height_intensity, "height-intensity", "Height and intensity",
         "height (z), and the intensity as its brightness", Colouring::shaded_height, Source::intensity, "intensity",
         Mode::height, nullptr, false},
    };
    return table;
}

const ColourTraits& traits_of(ColourMode mode) { return colour_modes()[static_cast<std::size_t>(mode)]; }

}  // namespace pcm
