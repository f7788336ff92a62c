// Draws one point cloud: chooses nodes for the view, has them loaded in the background, uploads within a time budget
// and draws what is there. draw() never waits for a load.
//
// GL thread only, except where it says otherwise. Works in compatibility and core contexts of OpenGL 3.3 and later; the
// contexts of one share group may take turns. GLEW's function pointers must be loaded (a host like MeshLab has done it;
// else call glewInit(), whose GLEW_ERROR_NO_GLX_DISPLAY under EGL is harmless).
//
//     report = renderer.draw(camera, local_origin, options);
//     if (report.repaint) schedule another frame now;       // chunks lie ready, or the budget is still growing
//     else if (report.refining) set_wake's function will be called when something has arrived; a slow timer besides
//         (some 250 ms) covers chunks that another client of the same cache is loading
#pragma once

#include "cloud/geometry.h"
#include "gl/l1_cache.h"
#include "gl/splat_style.h"
#include "point_cloud.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace pcm {
inline namespace single_cloud {

struct RenderOptions {
    float point_size_px = 2;              // constant splats: squares with this side; clamped to what the driver can
    ColourMode colour = ColourMode::rgb;  // a cloud without rgb shows intensity, one without that height
    std::array<float, 3> uniform_colour{0.75f, 0.75f, 0.75f};
    double target_spacing_px = 1.4;           // refine until points are no farther apart than this on screen
    double frame_budget_ms = 33;              // of a moving view; fewer points are drawn when they would take longer
    double rest_budget_ms = 250;              // of a view that rests: how long a still picture may take
    std::uint64_t point_budget = 20'000'000;  // never draw more than this
    double upload_budget_ms = L1Cache::default_milliseconds;  // of a frame; one chunk is uploaded whatever it takes
    unsigned prefetch_frames = 8;             // what a moving view will need so many frames later is loaded ahead; 0: nothing is
};

struct Camera {
    double modelview[16];   // column-major; maps SOURCE coordinates minus local_origin to eye space
    double projection[16];  // column-major; perspective or orthographic
    int viewport[4];        // as glViewport has it: x, y, width, height
};

struct FrameReport {
    std::uint64_t points_drawn = 0;
    double screen_error_px = 0;  // largest spacing on screen where finer points exist; 0: all that is visible is drawn
    double frame_ms = 0;         // time in draw(), on the CPU
    double measured_ms = 0;      // latest measure of a frame until the last pixel; 0 before the first
    std::uint64_t nodes_drawn = 0;
    std::uint64_t nodes_wanted = 0;
    std::uint64_t nodes_missing = 0;  // wanted and not yet in video memory (or with the colours of another mode)
    std::uint64_t effective_point_budget = 0;  // what the time allowed this frame
    ColourMode colour_used = ColourMode::uniform;
    bool refining = false;  // more will come: the picture is not final yet
    bool repaint = false;   // ask for another frame at once; implies refining
    std::string error;      // the last background load error or OpenGL error; empty if none
};

class CloudRenderer {
public:
    // With an L1 of its own, or sharing one with the other clouds of the GL share group. Makes no GL object yet.
    explicit CloudRenderer(std::shared_ptr<PointCloud> cloud, const L1Options& l1 = {});
    CloudRenderer(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1);
    // GL objects that release() has not freed are abandoned to the context: destruction touches no OpenGL.
    ~CloudRenderer();
    CloudRenderer(const CloudRenderer&) = delete;
    CloudRenderer& operator=(const CloudRenderer&) = delete;

    // Draws into the current framebuffer with the current viewport, depth tested, and restores every piece of GL state
    // that it changes. Leaves no GL error; one that was pending on entry is dropped. Never throws for a failed load:
    // what could be loaded is drawn, and the report says what failed.
    FrameReport draw(const Camera& camera, const Vec3d& local_origin, const RenderOptions& options);

    // `wake` is called on a loader thread when chunks have arrived since the last draw(); it must return quickly and
    // not call back into this object (queue a repaint). Any thread. When set_wake returns, the former function runs no
    // more.
    void set_wake(std::function<void()> wake);

    // Frees the GL objects; a context of the share group must be current. draw() may be called again afterwards. A
    // shared L1 loses this cloud's entries only.
    void release();

    const std::shared_ptr<PointCloud>& cloud() const;
    const std::shared_ptr<L1Cache>& l1() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace single_cloud
}  // namespace pcm
