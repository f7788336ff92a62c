// Chooses the points of a chunk that are drawn: those of groups (gl/l1/vertex_groups.h) that may be in view, as quads
// where their splats may be larger than the driver's points. No OpenGL here.
#pragma once

#include "pcm/gl/draw/splat_camera.h"
#include "pcm/gl/draw/view_clips.h"
#include "pcm/gl/l1/l1_cache.h"
#include "pcm/gl/l1/vertex_groups.h"
#include "pcm/gl/style/chunk_look.h"
#include "pcm/gl/style/splat_style.h"

#include <optional>
#include <vector>

namespace pcm {

// Points at about the same distance from the eye.
struct SplatPart {
    double points = 0;           // in view, estimated
    double pixels_per_unit = 0;  // there, face-on
};

class SplatSieve {
public:
    // `largest_point`: driver's limit, pixels; `guard`: pixels by which the clip volume can be extended on each side.
    SplatSieve(const SplatCamera& camera, const CloudStyle& style, double largest_point, int guard);

    // Sorts a chunk's points; `box` encloses their positions, relative to the view's origin. Adds their places to
    // `parts` unless it is null. No visible point is left out, and none of as_points() is too large for the driver.
    // Groups of which `clips`, unless null, leave nothing are left out.
    void sort(const VertexEntry& entry, const Box3d& box, SplatShape shape, const ChunkLook& look,
              std::vector<SplatPart>* parts = nullptr, const ViewClips* clips = nullptr);
    std::uint32_t clipped() const { return clipped_; }  // points in groups that were left out for the clips
    const std::vector<VertexRun>& as_points() const { return as_points_; }  // in the chunk's order, as are
    const std::vector<VertexRun>& as_quads() const { return as_quads_; }

private:
    bool needs_quads(SplatShape shape, const Box3d& box, float largest_radius, const ChunkLook& look) const;
    double reach(SplatShape shape, float largest_radius, const ChunkLook& look) const;
    double depth_of(const Vec3d& place) const { return -camera_.eye_of(place)[2]; }
    double depth_range(const Box3d& box) const;  // depths of its points, relative to its centre's depth
    SplatPart part_of(const Box3d& box, std::uint32_t points) const;
    SplatPart part_in_view(const Box3d& box, std::uint32_t points) const;

    const SplatCamera& camera_;
    const CloudStyle& style_;
    double largest_point_;
    int guard_;
    std::optional<Frustum> seen_;  // the view with a border, relative to its origin
    std::uint32_t clipped_ = 0;
    std::vector<VertexRun> as_points_, as_quads_;
};

}  // namespace pcm
