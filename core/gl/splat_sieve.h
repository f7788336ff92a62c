// Which points of a chunk are drawn, and as what: those of groups (gl/vertex_groups.h) that may be in view; as quads
// where their splats may be larger than the driver's points. No OpenGL here.
#pragma once

#include "pcm/gl/chunk_look.h"
#include "pcm/gl/l1_cache.h"
#include "pcm/gl/splat_camera.h"
#include "pcm/gl/splat_style.h"
#include "pcm/gl/vertex_groups.h"

#include <optional>
#include <vector>

namespace pcm {

// Points that are about as far from the eye.
struct SplatPart {
    double points = 0;           // in view, about
    double pixels_per_unit = 0;  // that a source unit covers there, face on
};

class SplatSieve {
public:
    // `largest_point`: of the driver, pixels; `guard`: what the clip volume can be made wider by on each side for
    // points, pixels.
    SplatSieve(const SplatCamera& camera, const CloudStyle& style, double largest_point, int guard);

    // Sorts a chunk's points; `box` is that of their positions, relative to the view's origin. Adds to `parts`, if
    // there, where they are. Nothing is left out that can be seen, and no point is too large for the driver.
    void sort(const VertexEntry& entry, const Box3d& box, SplatShape shape, const ChunkLook& look,
              std::vector<SplatPart>* parts = nullptr);
    const std::vector<VertexRun>& as_points() const { return as_points_; }  // in the chunk's order, as are
    const std::vector<VertexRun>& as_quads() const { return as_quads_; }

private:
    bool needs_quads(SplatShape shape, const Box3d& box, float largest_radius, const ChunkLook& look) const;
    double reach(SplatShape shape, float largest_radius, const ChunkLook& look) const;
    double depth_of(const Vec3d& place) const { return -camera_.eye_of(place)[2]; }
    double depth_range(const Box3d& box) const;  // of its points, at most so many times either way of its centre's
    SplatPart part_of(const Box3d& box, std::uint32_t points) const;
    SplatPart part_in_view(const Box3d& box, std::uint32_t points) const;

    const SplatCamera& camera_;
    const CloudStyle& style_;
    double largest_point_;
    int guard_;
    std::optional<Frustum> seen_;  // the view with a border, relative to its origin
    std::vector<VertexRun> as_points_, as_quads_;
};

}  // namespace pcm
