// Draws lines and crosses of a given width in pixels over a picture of a scene.
//
// Ends are moved into the picture and clipped in double, relative to the eye: lines are where they belong at map
// coordinates, before near planes of 1e-6, and where an end lies 1e9 units away or behind the eye. They are clipped at
// the near plane, not at the far one. Each is about its own width nearer to the eye than its place, so that it is seen
// before splats that lie at its place. Antialiased, with a dark border of one pixel, so that it is seen on every
// ground.
//
// GL thread only. Works in compatibility and core contexts of OpenGL 3.3; the program is built on first use.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/gl/base/shader_program.h"
#include "pcm/view/camera.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pcm {

struct SceneLine {
    std::vector<Vec3d> points;                // joined by segments, source coordinates; what is not finite is left out
    bool closed = false;                      // the last point is joined with the first
    std::array<float, 4> colour{1, 1, 1, 1};  // red, green, blue, opacity, from 0 to 1
    double width_px = 2;
    float hidden = 0.25f;  // factor on the opacity of the parts behind what the framebuffer holds; 1: as visible
};

struct SceneMark {
    Vec3d at{};
    double size_px = 11;  // from end to end of the cross
    std::array<float, 4> colour{1, 1, 1, 1};
    double width_px = 2;
    float hidden = 0.25f;
};

class LinePass {
public:
    // Into the current framebuffer with the current viewport, whose size is the camera's; depth is tested against what
    // is there, in OpenGL's default convention (smaller is nearer), and not written. Restores every piece of GL state
    // that it changes. A camera that Frustum::of() refuses draws nothing. Throws Error(unsupported) when the driver
    // cannot compile the program.
    void draw(const Camera& camera, const std::vector<SceneLine>& lines, const std::vector<SceneMark>& marks);
    void release();

private:
    ShaderProgram program_;
};

}  // namespace pcm
