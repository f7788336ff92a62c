// Notices when MeshLab's tools have changed the vertices of a layer. MeshLab says nothing: filters and edit tools write
// into the mesh.
#pragma once

#include <cstddef>
#include <cstdint>

class MeshModel;

namespace pcm::host {

enum class Watched : std::uint8_t {
    sample,    // positions, colours, deleted vertices, faces: what a user sees of the sample of a tree
    vertices,  // also normals, quality, radii and float attributes: what a drawn copy of the layer is made of
};

// Equal for equal vertices. Selections do not count, nor does the layer's matrix.
struct LayerState {
    std::size_t vertices = 0, faces = 0;
    std::uint64_t hash = 0;

    bool operator==(const LayerState& o) const { return vertices == o.vertices && faces == o.faces && hash == o.hash; }
    bool operator!=(const LayerState& o) const { return !(*this == o); }
};

struct LayerCounts {
    std::size_t vertices = 0, faces = 0, edges = 0;
};
LayerCounts counts_of(const MeshModel& layer);

// Looks at `most` vertices at least, spread evenly; by default at all of them, about 10 ms per million.
LayerState state_of(const MeshModel& layer, Watched watched, std::size_t most = ~std::size_t(0));

// Vertices that a glance looks at: less than 0.1 ms in each paint event.
inline constexpr std::size_t glance_vertices = 4096;

}  // namespace pcm::host
