// Draws point clouds: chooses nodes for the view, has them loaded in the background, uploads within a time budget,
// draws what is there, and brings the picture into the host's framebuffer. draw() never waits for a load.
//
// A *Renderer* has what a GL share group has once (programs), a *DrawnCloud* what a cloud has once in a share group
// (its chunks on the way into L1), a *Picture* what a view has once (a framebuffer and what it holds). Clouds that are
// drawn together share one budget and one L1, by what the eye sees: the node with the largest error on the screen comes
// first, whichever cloud it is of.
//
//     report = renderer.draw(picture, view, {{&cloud, origin}}, options);
//     if (report.repaint) schedule another frame now;       // there is more to draw
//     else if (report.refining) set_wake's function will be called when something has arrived; a slow timer besides
//         (some 250 ms) covers chunks that another client of the same cache is loading
//
// While the view moves, a picture is as good as its time allows. When the same view is drawn again, it rests: what is
// drawn stays in the picture's framebuffer, and each frame adds what its time allows, best first, streaming through L1
// what does not fit, until every point that is in view has been drawn. That is the full-resolution picture, whatever
// the budgets are; further frames only bring it to the host.
//
// GL thread only, except where it says otherwise. Works in compatibility and core contexts of OpenGL 3.3 and later; the
// contexts of one share group may take turns. GLEW's function pointers must be loaded (a host like MeshLab has done it;
// else call glewInit(), whose GLEW_ERROR_NO_GLX_DISPLAY under EGL is harmless).
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/gl/l1_cache.h"
#include "pcm/gl/splat_style.h"
#include "pcm/point_cloud.h"
#include "pcm/view/level_of_detail.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pcm {

struct RenderOptions {
    double target_spacing_px = 1.4;           // refine until points are no farther apart than this on screen
    double frame_budget_ms = 33;              // fewer points are drawn in a frame when they would take longer
    std::uint64_t point_budget = 20'000'000;  // never draw more than this in a frame
    double upload_budget_ms = L1Cache::default_milliseconds;  // of a frame, at least while the view moves; one chunk is
                                                              // uploaded whatever it takes
    unsigned prefetch_frames = 8;  // what a moving view will need so many frames later is loaded ahead; 0: nothing is
    unsigned samples = 1;          // a pixel: 1 to what the driver has (FrameReport::samples)
    float eye_dome = 0;            // strength of eye-dome lighting, 1 is usual; 0: none
    bool converge = true;          // a view that rests goes on to the full-resolution picture; else to the target
    bool fill_gaps = true;         // while finer points are not drawn, splats are as large as the gaps that leaves
    DetailOrder order = DetailOrder::error;
};

// A cloud as one client of an L1 has it.
class DrawnCloud {
public:
    // Makes no GL object yet.
    DrawnCloud(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1);
    ~DrawnCloud();  // touches no OpenGL
    DrawnCloud(const DrawnCloud&) = delete;
    DrawnCloud& operator=(const DrawnCloud&) = delete;

    // `wake` is called on a loader thread when chunks have arrived since the last draw(); it must return quickly and
    // not call back into this object (queue a repaint). Any thread. When set_wake returns, the former function runs no
    // more.
    void set_wake(std::function<void()> wake);

    // Lets go of what the L1 has of this cloud. It may be drawn again afterwards.
    void release();

    const std::shared_ptr<PointCloud>& cloud() const;
    const std::shared_ptr<L1Cache>& l1() const;

private:
    friend class Renderer;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

struct SceneItem {
    DrawnCloud* cloud = nullptr;  // may be there again, in another place, but not in the colours of another attribute
    Vec3d origin{};               // source coordinates of the cloud's local origin
    Matrix4d placement = identity_matrix;  // from (source - origin) to the scene's coordinates; affine and invertible
    CloudStyle style;
};

struct CloudReport {
    std::uint64_t points_drawn = 0;
    CloudStyle style;    // as it was drawn
    std::string notice;  // what the cloud lacks for the style that was asked for
    std::string error;   // why some of it cannot be loaded for the time being
};

struct FrameReport {
    std::uint64_t points_drawn = 0;  // in the picture
    std::uint64_t points_added = 0;  // by this frame
    double screen_error_px = 0;  // largest spacing on screen where finer points exist; 0: all that is visible is drawn
    double frame_ms = 0;         // time in draw(), on the CPU
    double measured_ms = 0;      // latest measure of a frame's drawing until the last pixel; 0 before the first
    double upload_ms = 0;        // of this frame
    std::uint64_t nodes_drawn = 0;  // in the picture
    std::uint64_t nodes_wanted = 0;
    std::uint64_t nodes_missing = 0;  // wanted and not yet in video memory (or with the attributes of another style)
    std::uint64_t effective_point_budget = 0;  // what the time allowed this frame
    unsigned samples = 1;                      // that the picture has
    bool full_resolution = false;              // every point in view is in the picture
    bool refining = false;                     // more will come: the picture is not final yet
    bool repaint = false;                      // ask for another frame at once; implies refining
    std::string error;                         // the last background load error or OpenGL error; empty if none
    std::vector<CloudReport> clouds;           // as the items
};

struct PictureState;

// What a view shows. Belongs to the context it was first drawn in; GL objects that release() has not freed are
// abandoned to it.
class Picture {
public:
    Picture();
    ~Picture();
    Picture(Picture&&) noexcept;
    Picture& operator=(Picture&&) noexcept;
    // The next frame begins anew: the points of a cloud are no longer what they were.
    void invalidate();
    void release();

private:
    friend class Renderer;
    std::unique_ptr<PictureState> impl_;
};

class Renderer {
public:
    // All clouds that it is given have this L1.
    explicit Renderer(std::shared_ptr<L1Cache> l1);
    ~Renderer();  // touches no OpenGL; release() frees the programs
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    // Draws into the current framebuffer with the current viewport, whose size is the view's, depth tested against what
    // is there and written. view.origin is not used: each item has its own. Restores every piece of GL state that it
    // changes. Leaves no GL error; one that was pending on entry is dropped. Never throws for a failed load: what could
    // be loaded is drawn, and the report says what failed.
    FrameReport draw(Picture& picture, const Camera& view, const std::vector<SceneItem>& items,
                     const RenderOptions& options);
    void release();

    const std::shared_ptr<L1Cache>& l1() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace pcm
