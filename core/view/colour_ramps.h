// Ramps: the colours of a scale of values. No OpenGL here; the shaders get the same table.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// New ones go to the end: MeshLab stores the number in its settings.
enum class ColourRamp : std::uint8_t {
    automatic,  // grey for intensity, viridis for everything else
    viridis,
    grey,
    turbo,
    diverging,
};

// Colours at even steps from the ramp's beginning to its end, interpolated linearly in between; red, green and blue
// from 0 to 1.
inline constexpr std::size_t ramp_stops = 17;
using RampTable = std::array<std::array<float, 3>, ramp_stops>;

struct RampTraits {
    ColourRamp ramp;
    const char* name;         // for command lines and scripts
    const char* label;        // for lists that people choose from
    const char* description;  // for tooltips
    // Lightness (CIE L*) rises in even steps, within 6 of 100: equal steps of the value look equally large, and the
    // order is visible without hues.
    bool is_even;
    RampTable table;  // for `automatic`: that of viridis
};

// In the order of the enumerators.
const std::vector<RampTraits>& colour_ramps();
const RampTraits& traits_of(ColourRamp ramp);

// t is clamped to 0..1.
std::array<float, 3> ramp_colour(float t, ColourRamp ramp = ColourRamp::viridis);

}  // namespace pcm
