// Restores the OpenGL state that drawing splats changes, in compatibility and core contexts alike.
//
// Nothing is pushed on the host's attribute stacks: they may be full, and client attributes pushed in MeshLab corrupt
// its text overlay.
#pragma once

#include <cstdint>
#include <string>

namespace pcm {

class GlStateGuard {
public:
    GlStateGuard();
    ~GlStateGuard();
    GlStateGuard(const GlStateGuard&) = delete;
    GlStateGuard& operator=(const GlStateGuard&) = delete;
    bool compatibility() const { return compatibility_; }

private:
    bool compatibility_ = false;
    std::int32_t program_ = 0;
    std::int32_t vertex_array_ = 0;
    std::int32_t array_buffer_ = 0;
    std::int32_t copy_write_buffer_ = 0;
    std::int32_t depth_function_ = 0;
    unsigned char depth_mask_ = 0;
    bool depth_test_ = false;
    bool blend_ = false;
    bool program_point_size_ = false;
    bool point_sprite_ = false;
    bool point_smooth_ = false;
};

// Whether the functions that this library calls are loaded.
bool gl_functions_loaded();

// Takes all pending errors off the context; their names, empty if there was none.
std::string drain_gl_errors();

}  // namespace pcm
