// Restores the OpenGL state that drawing splats changes, in compatibility and in core contexts.
//
// Nothing is pushed on the host's attribute stacks: they may be full, and client attributes pushed in MeshLab corrupt
// its text overlay.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pcm {

class GlStateGuard {
public:
    GlStateGuard();
    ~GlStateGuard();
    GlStateGuard(const GlStateGuard&) = delete;
    GlStateGuard& operator=(const GlStateGuard&) = delete;
    bool compatibility() const { return compatibility_; }

    // The host's framebuffer.
    std::uint32_t framebuffer() const { return static_cast<std::uint32_t>(draw_framebuffer_); }
    const std::array<std::int32_t, 4>& viewport() const { return viewport_; }
    std::array<float, 2> depth_range() const { return depth_range_; }

    // Sets the state for drawing a picture of our own: depth tested and written, no blending, clipping or masking.
    void set_plain() const;

private:
    struct Texture {
        std::uint32_t target;
        std::int32_t name;
    };
    bool compatibility_ = false;
    std::vector<std::pair<std::uint32_t, bool>> switches_;  // capability: whether it is on
    std::int32_t program_ = 0;
    std::int32_t vertex_array_ = 0;
    std::int32_t array_buffer_ = 0;
    std::int32_t copy_write_buffer_ = 0;
    std::int32_t draw_framebuffer_ = 0;
    std::int32_t read_framebuffer_ = 0;
    std::int32_t renderbuffer_ = 0;
    std::int32_t active_texture_ = 0;
    std::array<std::array<Texture, 2>, 3> textures_{};  // bindings of the first three units
    std::array<std::int32_t, 3> samplers_{};
    std::array<std::int32_t, 4> viewport_{};
    std::array<std::int32_t, 4> blend_{};  // source and destination, of colour and alpha
    std::array<std::int32_t, 2> blend_equation_{};
    std::array<std::int32_t, 2> polygon_mode_{};
    std::array<std::int32_t, 2> clip_{};  // origin and depth mode
    std::array<float, 4> clear_colour_{};
    std::array<float, 2> depth_range_{};
    float clear_depth_ = 1;
    std::int32_t depth_function_ = 0;
    std::array<unsigned char, 4> colour_mask_{};
    unsigned char depth_mask_ = 0;
};

// Whether the functions that this library calls are loaded.
bool gl_functions_loaded();

// Whether the current context has the compatibility profile, or is older than profiles.
bool is_compatibility_context();

// Whether depth can run from 1 at the near plane to 0 at the far one with all the precision of float near 0 (OpenGL 4.5
// or ARB_clip_control).
bool gl_has_clip_control();

// Whether the current context is a software rasteriser.
bool gl_is_software();

// Clears all pending errors of the context and returns their names; empty if there was none.
std::string drain_gl_errors();

}  // namespace pcm
