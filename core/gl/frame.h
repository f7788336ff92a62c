// One frame of a Renderer: what it draws, and the steps that moving and resting views share.
#pragma once

#include "pcm/gl/picture_state.h"
#include "pcm/gl/splat_pass.h"
#include "pcm/gl/vertex_format.h"

#include <chrono>
#include <cstdint>
#include <vector>

namespace pcm {

// One item, ready for a frame.
struct FrameCloud {
    ChunkFeed* feed;
    std::size_t leader;  // the first item of the same cloud, which loads for all of them; mostly itself
    const Tree* tree;
    Camera view;
    CloudStyle style;
    VertexFormat format;
    std::vector<bool> current;    // of its `wanted`: in L1 with the attributes of the style
    std::vector<NodeId> window;   // to be loaded
    std::vector<float> residual;  // of its `wanted`: the largest error of what is in view below and not drawn, pixels
    // How far points are apart where finer ones are not drawn: source units, and on the screen at its nearest point. 0:
    // nowhere too far.
    struct Gap {
        double spacing = 0;
        double spacing_px = 0;
    };
    std::vector<Gap> gaps;  // of its `wanted`, below each
    bool filled = false;    // some of its splats are larger than their own size
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
    DetailLimits limits{};   // of a moving view
    bool converges = false;  // the view rests, and goes on to full resolution
    FrameReport report{};
    double drawing_ms = 0;  // of frame_ms
    FrameWork work{};

    std::vector<TreeInView> trees() const;
    // What the budgets of time, points and video memory allow.
    DetailLimits current_limits();
    // Adds to what the item's leader has to load, as far as there is room.
    void want(std::size_t item, const std::vector<NodeId>& nodes);
    // Begins the splats of a cloud, into the picture's target.
    void begin(const FrameCloud& cloud);
    // Uploads what has come of the clouds' windows, for the cloud first that lacks what is worth most.
    Served upload(const SceneSelection& selection);
};

double milliseconds_since(Frame::Clock::time_point start);

// Splats of this many times the spacing leave few gaps between the points of a level, which lie no nearer than the
// spacing and leave no disc of that radius empty.
inline constexpr double fill_of_spacing = 1.4;

// How large splats are to be, in whole pixels, so that this spacing shows no gaps; 0 where the style's own do.
float fill_of(double spacing_px, const CloudStyle& style);

// Draws entries one after the other; neighbours of one cloud share what is set once.
class Strokes {
public:
    explicit Strokes(Frame& frame) : frame_(frame) {}
    ~Strokes()
    {
        if (cloud_) frame_.splats.end();
    }
    void draw(const FrameCloud& cloud, const DetailNode& node, const VertexEntry& entry, float residual,
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
        look.least_radius = static_cast<float>(0.5 * fill_of_spacing * gap.spacing);
        look.least_px = fill_of(gap.spacing_px, cloud.style);
        frame_.splats.draw(entry, look);
    }

private:
    Frame& frame_;
    const FrameCloud* cloud_ = nullptr;
};

// Draws, measures it and learns from it. The picture's target, or `next`, is bound.
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
    frame.drawing_ms = milliseconds_since(start);
}

// What a view that has moved, or whose chunks are still coming, shows. When a resting one shows all that it should,
// `picture.rest` begins.
void draw_moving(Frame& frame, const SceneSelection& selection, bool resting);

// The picture holds all of `rest->lod` that can be had, `drawn` of each tree's `wanted`; what follows is added to it.
void begin_rest(Frame& frame, const SceneSelection& lod, const std::vector<std::vector<bool>>& drawn);
void draw_resting(Frame& frame);

}  // namespace pcm
