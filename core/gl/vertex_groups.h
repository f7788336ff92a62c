// Boxes of a few consecutive points of a chunk: what is outside of a view need not be drawn, and what is far from the
// eye not as if it were near. Points of a level are stored in Morton order, so these lie close together. No OpenGL
// here.
#pragma once

#include "pcm/bpc/chunk.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pcm {

struct VertexGroup {
    static constexpr std::size_t points = 128;  // a group; the last has what is left
    // Of the positions as they are uploaded: relative to the chunk's origin, source units.
    std::array<float, 3> low{}, high{};
    float largest_radius = 0;
};

// Of all points; the scale is positive. `radii` may be null.
std::vector<VertexGroup> make_groups(const ChunkPositions& positions, const Vec3d& scale, const float* radii);

// Consecutive points of a chunk.
struct VertexRun {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
};

// Adds points to the last run where they follow it.
void add_run(std::vector<VertexRun>& runs, std::uint32_t first, std::uint32_t count);

}  // namespace pcm
