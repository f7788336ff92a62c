// An OpenGL context without a window or a display server, made by EGL, and a framebuffer to draw into.
#pragma once

#include "pcm/offscreen/image.h"

#include <array>
#include <memory>
#include <string>

namespace pcm {

enum class OffscreenProfile { compatibility, core };

// Current on the thread that made it, until it is destroyed or another one is made current. GLEW's functions are
// loaded. OpenGL 3.3, or a later version that the driver gives instead.
class Offscreen {
public:
    // On a hardware device where EGL lists one, else on Mesa's software rasteriser. The framebuffer, RGBA8 and 24 bits
    // of depth, is bound and the viewport set. Objects are shared with `share`, which may be null and must be on the
    // same device. Throws Error(unsupported) "no OpenGL context ..." where OpenGL 3.3 is unavailable, with what to
    // install; Error(invalid_argument) for a size that the driver cannot draw.
    explicit Offscreen(int width = 16, int height = 16, OffscreenProfile profile = OffscreenProfile::compatibility,
                       const Offscreen* share = nullptr);
    ~Offscreen();
    Offscreen(const Offscreen&) = delete;
    Offscreen& operator=(const Offscreen&) = delete;

    void make_current() const;  // and binds the framebuffer
    int width() const;
    int height() const;
    // Colour and depth; with alpha 0 the picture is transparent where nothing is drawn.
    void clear(const std::array<float, 4>& colour = {0, 0, 0, 1}) const;
    Image read() const;            // the framebuffer's colours
    std::string renderer() const;  // the driver's name and version

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pcm
