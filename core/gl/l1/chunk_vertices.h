// The vertices of a chunk as they lie in L1, made before they are uploaded: any thread can make them, and the GL thread
// only copies. No OpenGL here.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/geometry.h"
#include "pcm/gl/l1/vertex_format.h"
#include "pcm/gl/l1/vertex_groups.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// The attributes of the format in addition to positions; others may be null.
struct VertexAttributes {
    const std::uint8_t* colours = nullptr;  // 4 bytes per point: RGBA, or a float where is_value() of the source
    const float* radii = nullptr;           // 1 per point
    const float* normals = nullptr;         // 3 per point
    const std::uint32_t* shapes = nullptr;  // 1 per point (view/point_shapes.h); null: unknown
    // Which points are selected: a byte per point, not 0 for these; null if none is. The number says which they are, so
    // that the owner recognises vertices of another selection; 0: nothing is selected.
    const std::uint8_t* selected = nullptr;
    std::uint64_t selection = 0;
};

// What is known of a chunk's vertices without reading them.
struct VertexFacts {
    VertexFormat format;
    std::uint32_t points = 0;
    std::uint32_t hidden = 0;     // points of the chunk that have no vertex
    std::uint64_t selection = 0;  // VertexAttributes::selection; not 0: x of selected points has a minus sign
    Vec3i origin{};               // origin of the chunk, grid coordinates
    Vec3d extent{};               // extent of the chunk, source units
    float largest_radius = 0;     // largest radius of its points, source units; for a format with radii
    float typical_radius = 0;     // root mean square of the radii
    std::vector<VertexGroup> groups;
    std::uint32_t stride() const { return format.stride(); }
};

struct ChunkVertices : VertexFacts {
    std::vector<std::byte> bytes;  // stride() per point
};

// `hidden`: points that the chunk has in addition to these.
ChunkVertices make_vertices(const ChunkPositions& positions, const Vec3d& scale, const VertexFormat& format,
                            const VertexAttributes& attributes, std::uint32_t hidden = 0);

}  // namespace pcm
