// The kinds of splats, one row of a table each. No OpenGL here.
//
// A new kind is an enumerator, a row in splat_modes.cpp, and its permutation in shaders/splat.vert and splat.frag; a
// uniform that no kind has yet is added in splat_program.cpp. Everything else follows from the row: vertex format,
// programs, culling, the choices of `pcmlab render`, of MeshLab's settings and of the benchmarks.
#pragma once

#include <cstdint>
#include <vector>

namespace pcm {

// What a point is drawn as. The radius is the point's own or, where it has none, its size (tree/point_size.h), which
// closes surfaces (Botsch and Kobbelt 2003; Zwicker et al. 2004 for the affine one). New ones go to the end:
// MeshLab stores the number in its settings.
enum class SplatMode : std::uint8_t {
    constant,     // a square of a fixed number of pixels
    adaptive,     // a square as large as a sphere of the point's radius appears
    affine,       // the point's disc, projected as if the view were parallel around its centre
    perspective,  // the disc itself: each fragment's ray is intersected with its plane, depth included
    fitted,  // by the point's surroundings (view/point_shapes.h): a disc in the surface, thin along a line, small and
             // round among leaves
};

// What bounds a splat on the screen. Culling, the largest size of GL_POINTS and the estimate of a frame's cost follow
// from it.
enum class SplatShape : std::uint8_t {
    pixels,   // a square of a fixed number of pixels, visible only while its centre is in the view
    sphere,   // the image-aligned square around a sphere of the point's radius
    ellipse,  // an ellipse within the square around a sphere of the point's radius, half a pixel wider
    disc,     // the box around the disc of the point's radius and normal; splat.frag finds the pixels and their depths
};

struct SplatTraits {
    SplatMode mode;
    const char* name;         // for command lines and scripts
    const char* label;        // for lists that people choose from
    const char* description;  // for tooltips, after "What a point is drawn as: "
    bool reads_radius;        // or the size
    bool reads_normal;
    bool reads_shape;  // of the points' surroundings
    SplatShape shape;
    const char* define;     // the shaders' permutation; empty for none
    bool has_doubles;       // the shaders have a permutation DOUBLE of it
    SplatMode when_absent;  // drawn in its place where an attribute that it reads is missing; reads fewer of them
    SplatMode in_parallel;  // discs: drawn in its place, with ORTHOGRAPHIC, in an orthographic view
};

// In the order of the enumerators.
const std::vector<SplatTraits>& splat_modes();
const SplatTraits& traits_of(SplatMode mode);
inline const char* name_of(SplatMode mode) { return traits_of(mode).name; }

// The mode itself, or the nearest one that can be drawn with these attributes.
SplatMode drawable_mode(SplatMode mode, bool has_radius, bool has_normal, bool has_shape = true);

}  // namespace pcm
