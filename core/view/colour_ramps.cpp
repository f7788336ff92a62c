#include "pcm/view/colour_ramps.h"

#include <algorithm>

namespace pcm {
namespace {

using Colour = std::array<float, 3>;

Colour between(const Colour& a, const Colour& b, float part)
{
    Colour colour{};
    for (std::size_t c = 0; c < 3; ++c) colour[c] = (1 - part) * a[c] + part * b[c];
    return colour;
}

template <std::size_t count>
RampTable table_of(const std::array<Colour, count>& stops)
{
    static_assert((ramp_stops - 1) % (count - 1) == 0);
    constexpr std::size_t per_stop = (ramp_stops - 1) / (count - 1);
    RampTable table{};
    for (std::size_t i = 0; i + 1 < ramp_stops; ++i)
        table[i] = between(stops[i / per_stop], stops[i / per_stop + 1],
                           static_cast<float>(i % per_stop) / static_cast<float>(per_stop));
    table.back() = stops.back();
    return table;
}

constexpr std::array<Colour, 5> viridis{{{0.267f, 0.005f, 0.329f},
                                         {0.230f, 0.322f, 0.546f},
                                         {0.128f, 0.567f, 0.551f},
                                         {0.369f, 0.789f, 0.383f},
                                         {0.993f, 0.906f, 0.144f}}};

// Not black: points of the lowest value are visible on a black background.
constexpr std::array<Colour, 2> grey{{{0.08f, 0.08f, 0.08f}, {1, 1, 1}}};

// After Anton Mikhailov's Turbo (2019).
constexpr std::array<Colour, 17> turbo{{{0.190f, 0.072f, 0.232f},
                                        {0.288f, 0.244f, 0.686f},
                                        {0.269f, 0.415f, 0.935f},
                                        {0.197f, 0.586f, 0.970f},
                                        {0.148f, 0.740f, 0.881f},
                                        {0.162f, 0.866f, 0.733f},
                                        {0.250f, 0.953f, 0.573f},
                                        {0.401f, 0.993f, 0.428f},
                                        {0.589f, 0.982f, 0.313f},
                                        {0.777f, 0.921f, 0.231f},
                                        {0.932f, 0.814f, 0.177f},
                                        {1.000f, 0.670f, 0.142f},
                                        {1.000f, 0.502f, 0.114f},
                                        {0.935f, 0.329f, 0.084f},
                                        {0.786f, 0.175f, 0.047f},
                                        {0.632f, 0.070f, 0.010f},
                                        {0.480f, 0.016f, 0.011f}}};

// Kenneth Moreland's "Diverging Color Maps for Scientific Visualization" (2009), blue to red.
constexpr std::array<Colour, 9> diverging{{{0.231f, 0.298f, 0.753f},
                                           {0.384f, 0.510f, 0.918f},
                                           {0.553f, 0.690f, 0.996f},
                                           {0.722f, 0.816f, 0.976f},
                                           {0.867f, 0.867f, 0.867f},
                                           {0.961f, 0.769f, 0.678f},
                                           {0.957f, 0.604f, 0.482f},
                                           {0.871f, 0.376f, 0.302f},
                                           {0.706f, 0.016f, 0.149f}}};

}  // namespace

const std::vector<RampTraits>& colour_ramps()
{
    using Ramp = ColourRamp;
    static const std::vector<RampTraits> table{
        {Ramp::automatic, "auto", "Automatic", "grey for intensity, viridis for everything else", true,
         table_of(viridis)},
        {Ramp::viridis, "viridis", "Viridis", "dark blue, teal, green, yellow, in even steps of lightness", true,
         table_of(viridis)},
        {Ramp::grey, "grey", "Grey", "dark to white, in even steps of lightness", true, table_of(grey)},
        {Ramp::turbo, "turbo", "Turbo (rainbow)",
         "blue, cyan, green, yellow, red: many hues to distinguish values, lightest in the middle", false,
         table_of(turbo)},
        {Ramp::diverging, "diverging", "Diverging",
         "blue, light grey, red: for values on both sides of a middle, which is lightest", false, table_of(diverging)},
    };
    return table;
}

const RampTraits& traits_of(ColourRamp ramp) { return colour_ramps()[static_cast<std::size_t>(ramp)]; }

std::array<float, 3> ramp_colour(float t, ColourRamp ramp)
{
    const RampTable& table = traits_of(ramp).table;
    const float s = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(ramp_stops - 1);
    const std::size_t first = std::min(static_cast<std::size_t>(s), ramp_stops - 2);
    return between(table[first], table[first + 1], s - static_cast<float>(first));
}

}  // namespace pcm
