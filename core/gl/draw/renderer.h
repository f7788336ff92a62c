// Draws point clouds: chooses nodes for the view, requests them from loader threads, uploads within a time budget,
// draws the resident ones, and composites the picture into the host's framebuffer. draw() never waits for a load.
//
// A *Renderer* holds what a GL share group needs once (programs), a *DrawnCloud* what a cloud needs once per share
// group (its chunks on the way into L1), a *Picture* what a view needs once (a framebuffer). Clouds that are drawn
// together share one budget and one L1: the node with the largest error on the screen comes first, of whichever cloud.
//
//     report = renderer.draw(picture, view, {{&cloud, origin}}, options);
//     if (report.repaint) schedule another frame now;       // there is more to draw
//     else if (report.refining) wait: set_wake's function is called when a chunk has arrived, and a slow timer (some
//         250 ms) covers chunks that another client of the same cache is loading
//
// While the view moves, a picture is as good as its time allows. When the same view is drawn again, it rests: the
// picture's framebuffer is kept, and each frame adds as many chunks as its time allows, largest error first, streaming
// through L1 what does not fit, until every point in view has been drawn. That is the full-resolution picture, whatever
// the budgets are. Then, where RenderOptions::smooth_frames is above 1, it is drawn again at sub-pixel offsets, and the
// mean of these frames is shown; its depth stays that of the first. Further frames only composite it into the host's
// framebuffer.
//
// GL thread only, unless a member says otherwise. Works in compatibility and core contexts of OpenGL 3.3 and later; the
// contexts of one share group may take turns. GLEW's function pointers must be loaded (a host like MeshLab has done it;
// else call glewInit(), whose GLEW_ERROR_NO_GLX_DISPLAY under EGL is harmless).
#pragma once

#include "pcm/cloud/clip.h"
#include "pcm/cloud/geometry.h"
#include "pcm/gl/l1/l1_cache.h"
#include "pcm/gl/style/splat_style.h"
#include "pcm/point_cloud.h"
#include "pcm/query/point_set.h"
#include "pcm/view/level_of_detail.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// What windows and `pcmlab render` use for RenderOptions::smooth_frames, and the maximum that has an effect.
inline constexpr unsigned usual_smooth_frames = 16, most_smooth_frames = 256;

struct RenderOptions {
    double target_spacing_px = 1.4;           // refine until points are at most this far apart on screen
    double frame_budget_ms = 33;              // fewer points are drawn in a frame when they would take longer
    std::uint64_t point_budget = 20'000'000;  // never draw more than this in a frame
    double upload_budget_ms = L1Cache::default_milliseconds;  // per frame while the view moves; at least one chunk is
                                                              // uploaded
    unsigned prefetch_frames = 8;  // a moving view loads ahead what it will need in this many frames; 0: nothing
    unsigned samples = 1;          // per pixel: 1 to 8, or the driver's most (FrameReport::samples)
    float eye_dome = 1;            // strength of eye-dome lighting; 0: none
    bool converge = true;          // a resting view refines to full resolution; else to the target
    // The picture of a resting view, once it is complete, becomes the mean of at most this number of frames at
    // sub-pixel offsets (view/pixel_offset.h): edges and far textures neither shimmer nor have stairs. 1: it is not
    // changed. Views of more points have fewer frames (FrameReport::smooth_frames), some even none.
    unsigned smooth_frames = 1;
    bool paraboloids = false;  // adaptive splats in every frame as in a view that rests; else squares while it moves
    // While finer points are not drawn, splats grow to fill the gaps; and where splats that lie in surfaces leave gaps
    // of a few pixels, these are filled in the picture.
    bool fill_gaps = true;
    DetailOrder order = DetailOrder::error;
};

// A cloud as one client of an L1.
class DrawnCloud {
public:
    // Makes no GL object yet.
    DrawnCloud(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1);
    ~DrawnCloud();  // touches no OpenGL
    DrawnCloud(const DrawnCloud&) = delete;
    DrawnCloud& operator=(const DrawnCloud&) = delete;

    // `wake` is called on a loader thread when chunks have arrived since the last draw(); it must return quickly and
    // not call back into this object (queue a repaint). Any thread. When set_wake returns, the former function is not
    // running and will not be called again.
    void set_wake(std::function<void()> wake);

    // Drops this cloud's chunks from the L1. It may be drawn again afterwards.
    void release();

    const std::shared_ptr<PointCloud>& cloud() const;
    const std::shared_ptr<L1Cache>& l1() const;

private:
    friend class Renderer;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

struct SceneItem {
    // May occur twice with other placements, but not with colours of two attributes, with other conditions, or with
    // other clips that have no planes.
    DrawnCloud* cloud = nullptr;
    Vec3d origin{};                        // source coordinates of the cloud's local origin
    Matrix4d placement = identity_matrix;  // from (source - origin) to the scene's coordinates; affine and invertible
    CloudStyle style;
    // Only points that all of these leave are shown; source coordinates of the cloud. Clips with planes are moved
    // without uploading points again, others (spheres, rays, cones) not.
    std::vector<Clip> clips;
    // Shown in another colour; null: none. It belongs to the cloud's tree, else nothing is shown as selected. For two
    // items of one cloud it is the same.
    std::shared_ptr<const PointSet> selected;
    std::array<float, 3> selected_colour{1.0f, 0.25f, 0.05f};
};

struct CloudReport {
    // Without those that clips hide, but for up to 127 in each group of consecutive points that a clip's border cuts.
    std::uint64_t points_drawn = 0;
    std::uint64_t points_hidden = 0;  // points in addition to these, hidden by the style's conditions
    CloudStyle style;                 // as it was drawn
    std::uint32_t vertex_bytes = 0;   // size of a point in video memory
    std::optional<ValueRange> range;  // at the ends of the ramp; absent for other colours, and while it is not known
    ClassSet classes;                 // classes that occur in video memory, for colours by class
    std::string
        notice;  // the attributes that the style asked for and the cloud lacks, or which are the same in a sample of it
    std::string error;  // why some chunks cannot be loaded at present
};

struct FrameReport {
    std::uint64_t points_drawn = 0;  // in the picture
    std::uint64_t points_added = 0;  // points added by this frame
    double screen_error_px = 0;  // largest spacing on screen where finer points exist; 0: all visible points are drawn
    double frame_ms = 0;         // time in draw(), on the CPU
    double measured_ms = 0;      // latest measured time from a frame's first call to its last pixel; 0: none yet
    double upload_ms = 0;        // upload time of this frame
    std::uint64_t nodes_drawn = 0;  // in the picture
    std::uint64_t nodes_wanted = 0;
    std::uint64_t nodes_missing = 0;  // wanted, and absent from video memory or there with another style's attributes
    std::size_t programs = 0;         // shader programs that the renderer has built so far, the compositor's among them
    std::uint64_t effective_point_budget = 0;  // allowed by the frame budget
    unsigned samples = 1;                      // samples of the picture
    unsigned frames_averaged = 1;              // in the picture
    unsigned smooth_frames = 1;                // in the final one; known when `smoothing` is true, or nothing refines
    // Every point in view is in the picture, less those that conditions or clips hide, and as large as it is meant to
    // be.
    bool full_resolution = false;
    bool refining = false;   // the picture is not final yet
    bool smoothing = false;  // and all that it lacks is frames for the mean
    bool repaint = false;    // ask for another frame at once; implies refining
    // Seconds after which a frame loads again what could not be loaded; 0: nothing failed.
    double retry_seconds = 0;
    // The last background load error or OpenGL error, or why a cloud cannot be drawn: its extent is below 1e-33 or
    // above 1e30, or the view's numbers are above 1e35. Empty if none.
    std::string error;
    std::vector<CloudReport> clouds;  // in the order of the items
};

struct PictureState;

// The framebuffer of a view. Belongs to the context in which it was first drawn; GL objects that release() has not
// freed live until that context ends.
class Picture {
public:
    Picture();
    ~Picture();
    Picture(Picture&&) noexcept;
    Picture& operator=(Picture&&) noexcept;
    // The next frame starts from an empty picture: call it when the points of a cloud have changed.
    void invalidate();
    void release();

private:
    friend class Renderer;
    std::unique_ptr<PictureState> impl_;
};

class Renderer {
public:
    // All clouds that it draws use this L1.
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
