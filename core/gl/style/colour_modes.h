// What the colour of a point shows, one row of a table each. No OpenGL here.
//
// A new mode is an enumerator and a row in colour_modes.cpp. A new attribute to read is a ColourSource
// (view/point_colours.h); a new colouring a permutation of shaders/splat.vert.
#pragma once

#include "pcm/view/colour_ramps.h"
#include "pcm/view/point_colours.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pcm {

struct ChunkLook;
struct CloudStyle;

// New ones go to the end: MeshLab stores the number in its settings.
enum class ColourMode : std::uint8_t {
    rgb,
    intensity,
    height,          // z
    classification,  // the classes of LAS 1.4, each in its own colour
    level,           // the coarsest level of detail among the chunk's points
    error,           // on the screen, the distance between points where no finer chunk is drawn below this one
    uniform,
    attribute,         // any other, named in the style
    height_intensity,  // z, and the intensity as brightness
};

// Where the shader finds the colour.
enum class Colouring : std::uint8_t {
    vertex,         // in the vertex, made from the mode's source
    value,          // on the style's ramp, by the number in the vertex, made from the mode's source
    height,         // on the ramp, by the vertex's z
    chunk,          // one colour for all points of a chunk
    shaded_height,  // on the ramp, by the vertex's z, as bright as the number in the vertex is large
};

struct ColourTraits {
    ColourMode mode;
    const char* name;         // for command lines and scripts
    const char* label;        // for lists that people choose from
    const char* description;  // for tooltips, after "What the colour of a point shows: "
    Colouring colouring;
    ColourSource source;     // Colouring::vertex, value and shaded_height: the attribute that it reads
    const char* absent;      // with a source: what a cloud without it lacks, for messages
    ColourMode when_absent;  // with a source: shown in its place then, and where it is the same for all points
    // Colouring::chunk; else null.
    std::array<float, 3> (*of_chunk)(const CloudStyle& style, const ChunkLook& look, unsigned levels);
    // The colour of a chunk changes when finer chunks are drawn: nothing can be added to a finished picture.
    bool changes_with_detail;
};

// In the order of the enumerators.
const std::vector<ColourTraits>& colour_modes();
const ColourTraits& traits_of(ColourMode mode);
inline const char* name_of(ColourMode mode) { return traits_of(mode).name; }

// Whether its colours are those of a range of values, which the automatic range or the user gives.
inline bool has_range(ColourMode mode)
{
    const Colouring colouring = traits_of(mode).colouring;
    return colouring == Colouring::value || colouring == Colouring::height || colouring == Colouring::shaded_height;
}

}  // namespace pcm
