// Boxes of a few consecutive points of a chunk, to cull groups outside the view and to draw distant groups at their own
// distance. Points of a level are stored in Morton order, so groups are compact. No OpenGL here.
#pragma once

#include "pcm/bpc/chunk.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pcm {

struct VertexGroup {
    static constexpr std::size_t points = 128;  // per group; the last may have fewer
    // The box of the positions as uploaded: relative to the chunk's origin, source units.
    std::array<float, 3> low{}, high{};
    float largest_radius = 0;
};

// The groups of all points; the scale is positive. `radii` may be null.
std::vector<VertexGroup> make_groups(const ChunkPositions& positions, const Vec3d& scale, const float* radii);

// Consecutive points of a chunk.
struct VertexRun {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
};

// Extends the last run where the points follow it.
void add_run(std::vector<VertexRun>& runs, std::uint32_t first, std::uint32_t count);

}  // namespace pcm
