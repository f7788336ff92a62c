// One frame of a Renderer: its clouds, and the steps that moving and resting views share.
#pragma once

#include "pcm/gl/draw/picture_state.h"
#include "pcm/gl/draw/splat_pass.h"
#include "pcm/gl/draw/view_clips.h"
#include "pcm/gl/l1/vertex_format.h"
#include "pcm/gl/tuning.h"
#include "pcm/system/seconds.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <vector>

namespace pcm {

// One item, ready for a frame.
struct FrameCloud {
    ChunkFeed* feed;
    NodeLoader* nodes;
    std::size_t leader;  // the first item of the same cloud, which loads for all of them; usually itself
    const Tree* tree;
    Camera view;
    CloudStyle style;
    ShownValues values;
    ViewClips clips;
    std::array<float, 3> selected_colour;
    VertexFormat format;
    std::vector<bool> current;   // per node of `wanted`: in L1 with the attributes of the style
    std::vector<NodeId> window;  // to be loaded
    std::vector<float>
        residual;  // per node of `wanted`: the largest error of nodes in view below it that are not drawn, pixels
    // The spacing of points where finer ones are not drawn: in source units, and in pixels at its nearest point. 0: no
    // gaps.
    struct Gap {
        double spacing = 0;
        double spacing_px = 0;
    };
    std::vector<Gap> gaps;  // per node of `wanted`, below it
    bool filled = false;    // some of its splats are enlarged to fill gaps
};

struct Frame {
    using Clock = std::chrono::steady_clock;

    PictureState& picture;
    const RenderOptions& options;
    L1Cache& l1;
    SplatPass& splats;
    Clock::time_point start = Clock::now();
    std::vector<FrameCloud> clouds{};
    std::vector<L1Cache::Owner> owners{};
    DetailLimits limits{};   // limits of a moving view
    bool converges = false;  // the view rests, and refines to full resolution
    FrameReport report{};
    double drawing_ms = 0;  // part of frame_ms
    FrameWork work{};
    bool at_rest = options.paraboloids;  // adaptive splats are drawn as paraboloids
    // The picture is complete and is drawn once more, for a mean (gl/draw/smoothing.h): into `next`, at this offset in
    // pixels, as this one of the frames.
    bool again = false, drawn_again = false;
    std::array<double, 2> offset{};
    std::uint32_t frame_of_mean = 0;

    // Splats that lie in surfaces leave gaps where these are seen edge-on, and where the density of points changes.
    Finish finish(bool fast) const;
    // What the splats of this frame cost.
    bool costs_more() const { return at_rest && !options.paraboloids; }
    FrameBudget& costs() const { return costs_more() ? picture.rest_budget : picture.budget; }
    std::vector<TreeInView> trees() const;
    // As the budgets of time, points and video memory allow.
    DetailLimits current_limits();
    // Requests the nodes that the selections, the more urgent one first, lack.
    void read_nodes(const SceneSelection& selection, const SceneSelection* later = nullptr);
    // Whether nodes that a selection lacks will come: those that could not be read are tried again some time later.
    bool awaits_nodes(const SceneSelection& selection) const;
    std::size_t pages_read() const;  // pages of the trees' nodes that have been read
    bool waits() const;              // whether chunks or nodes are being read
    // Adds nodes to the window of the item's leader, as far as there is room.
    void want(std::size_t item, const std::vector<NodeId>& nodes);
    // Begins the splats of a cloud, into the picture's target.
    void begin(const FrameCloud& cloud);
    // Uploads loaded chunks of the clouds' windows, first for the cloud that lacks the node of highest priority.
    Served upload(const SceneSelection& selection);
};

// The size of splats, in whole pixels, that fills gaps of this spacing; 0 where the style's own size does.
float fill_of(double spacing_px, const CloudStyle& style);

// Draws entries one after the other; consecutive ones of one cloud share the state that is set once.
class Strokes {
public:
    explicit Strokes(Frame& frame) : frame_(frame) {}
    ~Strokes()
    {
        if (cloud_) frame_.splats.end();
    }
    // What SplatPass::draw() returns.
    std::uint32_t draw(const FrameCloud& cloud, const DetailNode& node, const VertexEntry& entry, float residual,
                       const FrameCloud::Gap& gap)
    {
        if (cloud_ != &cloud) {
            if (cloud_) frame_.splats.end();
            cloud_ = &cloud;
            frame_.begin(cloud);
        }
        ChunkLook look;
        look.level = static_cast<float>(cloud.tree->nodes()[node.node].first_level);
        look.error_px = residual;
        look.least_radius = static_cast<float>(0.5 * gl_tuning().splats.fill * gap.spacing);
        look.least_px = fill_of(gap.spacing_px, cloud.style);
        return frame_.splats.draw(entry, look);
    }

private:
    Frame& frame_;
    const FrameCloud* cloud_ = nullptr;
};

// Calls `draw`, measures its time on the device and feeds it to the budget. The picture's target, or `next`, is bound.
void begin_strokes(Frame& frame);
void end_strokes(Frame& frame);
template <class Draw>
void timed(Frame& frame, const Draw& draw)
{
    begin_strokes(frame);
    const auto start = Frame::Clock::now();
    {
        Strokes strokes(frame);
        draw(strokes);
    }
    frame.report.points_added = frame.work.points;
    end_strokes(frame);
    frame.drawing_ms = 1e3 * seconds_since(start);
}

// Draws a view that has moved, or whose chunks are still being loaded. When a resting one shows all of its selection,
// `picture.rest` begins.
void draw_moving(Frame& frame, const SceneSelection& selection, bool resting);

// Whether splats filled gaps, or are drawn in another way at rest, so that they give way to those of the resting view.
bool differs_at_rest(const Frame& frame);

// The picture holds the chunks of `rest->lod` that could be loaded, `drawn` of each tree's `wanted`; later frames add
// to it.
void begin_rest(Frame& frame, const SceneSelection& lod, const std::vector<std::vector<bool>>& drawn);
void draw_resting(Frame& frame);
// Draws a part of all points in view into the picture's `next`, at the frame's offset; `again` says how far that is,
// and the report is that of the picture that is shown. Returns whether `next` is complete; false in `possible` when it
// never will be.
bool draw_again(Frame& frame, PictureState::Rest& again, bool& possible);

}  // namespace pcm
