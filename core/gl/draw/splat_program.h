// The programs of the splats: permutations of shaders/splat.vert and splat.frag, and their uniforms.
//
// GL thread only.
#pragma once

#include "pcm/cloud/vector.h"
#include "pcm/gl/base/shader_program.h"
#include "pcm/gl/draw/splat_camera.h"
#include "pcm/gl/draw/view_clips.h"
#include "pcm/gl/l1/l1_cache.h"
#include "pcm/gl/style/chunk_look.h"
#include "pcm/gl/style/splat_style.h"
#include "pcm/tree/tree.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

struct SplatPermutation {
    SplatMode mode = SplatMode::constant;
    Colouring colouring = Colouring::chunk;
    bool orthographic = false;
    bool quads = false;  // instanced strips of four vertices in place of points
    unsigned samples = 1;
    bool doubles = false;
    bool paraboloid = false;  // for the mode adaptive
    bool clips = false;
    bool selected = false;  // some points of the chunk are

    bool operator<(const SplatPermutation& o) const;
    std::vector<std::string> defines() const;
};

// What all chunks of a cloud have in common in a picture.
struct SplatView {
    SplatCamera camera;
    const TreeInfo* info = nullptr;
    CloudStyle style;
    std::array<int, 4> viewport{};  // x, y, width, height
    int guard = 0;                  // pixels by which the clip volume is extended on each side, for SplatShape::sphere
    float largest_point = 1;        // driver's limit, pixels
    ShownValues values;
    const ViewClips* clips = nullptr;  // none: nothing is clipped
    std::array<float, 3> selected_colour{};
    std::uint32_t frame = 0;  // ShownPoints::frame

    // The box of a chunk's positions, relative to the view's origin.
    Box3d box_of(const VertexEntry& entry) const;
    // Which of the chunk's points the clips that shaders test leave.
    BoxRelation kept_of(const Box3d& local) const
    {
        if (!clips) return BoxRelation::inside;
        return clips->relation({local.min + camera.view.origin, local.max + camera.view.origin});
    }
};

class SplatProgram {
public:
    // Throws Error(unsupported) when the driver cannot compile it.
    explicit SplatProgram(const SplatPermutation& permutation);
    std::uint32_t id() const { return program_.id(); }
    void release() { program_.release(); }

    // The program must be in use. Uniforms that the permutation does not have are skipped.
    void set_view(const SplatView& view) const;
    void set_chunk(const SplatView& view, const VertexEntry& entry, const ChunkLook& look) const;

private:
    void set_disc(const SplatView& view) const;
    void set_clips(const SplatView& view, const Vec3d& reference, const Vec3d& extent) const;
    void set_values(const SplatView& view, const VertexEntry& entry) const;
    void set(std::int32_t place, const Vec3d& v) const;
    void set(std::int32_t place, const std::array<double, 2>& v) const;
    void set(std::int32_t place, const std::array<double, 9>& matrix) const;

    // Locations; -1 where the permutation has none.
    struct Uniforms {
        std::int32_t projection, to_eye, eye_scale, point_size, pixels, radius_scale, viewport, guard;
        std::int32_t focal, principal, depth_of, sample_places, normal_to_eye;
        std::int32_t pixel_x, pixel_y, centre_ray, centre_pixel, pixel_bounds, near;
        std::int32_t reference, translation, from_eye, least_radius, least_pixels, ramp, ramp_place, uniform_colour;
        std::int32_t clip_planes, clip_ends, clip_count, clip_outside, selected_colour, tone, value_exponent, frame;
    };
    ShaderProgram program_;
    Colouring colouring_;
    unsigned samples_;
    bool doubles_;  // its uniforms of type real, rvec2, rvec3 and rmat3 are doubles
    Uniforms at_;
};

}  // namespace pcm
