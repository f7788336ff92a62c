// The state of a Picture and of a DrawnCloud, for renderer.cpp, moving_view.cpp, resting_view.cpp and smoothing.cpp.
#pragma once

#include "pcm/gl/base/render_target.h"
#include "pcm/gl/draw/chunk_feed.h"
#include "pcm/gl/draw/frame_budget.h"
#include "pcm/gl/draw/frame_clock.h"
#include "pcm/gl/draw/renderer.h"
#include "pcm/gl/tuning.h"
#include "pcm/tree/node_loader.h"

#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace pcm {

struct DrawnCloud::Impl {
    std::shared_ptr<PointCloud> cloud;
    std::shared_ptr<L1Cache> l1;
    std::unique_ptr<ChunkFeed> feed;
    std::unique_ptr<NodeLoader> nodes;
    std::uint64_t serial = 0;  // unique in the process
};

// What must be equal for frames to add to a picture.
struct PictureKey {
    struct Shown {
        std::uint64_t cloud;
        Vec3d origin;
        Matrix4d placement;
        CloudStyle style;
        ShownValues values;
        std::string clips;                         // their text
        std::shared_ptr<const PointSet> selected;  // kept, so that no other one has its address
        std::array<float, 3> selected_colour;
        bool operator==(const Shown& o) const
        {
            return cloud == o.cloud && origin == o.origin && placement == o.placement && style == o.style &&
                   values == o.values && clips == o.clips && selected == o.selected &&
                   selected_colour == o.selected_colour;
        }
    };
    Matrix4d modelview, projection;
    int width, height;
    double target_px;
    bool converge, fill_gaps;
    DetailOrder order;
    std::vector<Shown> items;

    bool operator==(const PictureKey& o) const
    {
        return modelview == o.modelview && projection == o.projection && width == o.width && height == o.height &&
               target_px == o.target_px && converge == o.converge && fill_gaps == o.fill_gaps && order == o.order &&
               items == o.items;
    }
    // Whether a point costs the same to draw: the styles are equal.
    bool looks_as(const PictureKey& o) const
    {
        if (items.size() != o.items.size()) return false;
        for (std::size_t i = 0; i < items.size(); ++i)
            if (items[i].style != o.items[i].style) return false;
        return true;
    }
};

struct PictureState {
    RenderTarget target;  // what is shown
    RenderTarget next;    // a resting view's, while `target` still shows enlarged splats; or a frame of the mean
    RenderTarget resolved;
    ColourTarget shades{ColourTarget::shades};  // while the view moves
    unsigned asked_samples = 1;
    FrameClock clock;
    FrameBudget budget;       // budget of a moving view
    FrameBudget rest_budget;  // what splats of a resting view cost
    std::optional<PictureKey> key;
    std::vector<Camera> views;  // cameras of the items, in the latest frame
    // This many next frames include the driver's compilation and are not measured.
    std::size_t unmeasured = gl_tuning().budget.unmeasured_frames;

    std::set<std::pair<std::uint64_t, NodeId>> kept;  // (cloud, node) drawn in the latest frame of a moving view

    // The share of the available video memory for what a moving view draws; chunks that only a resting view needs
    // stream through the rest. It shrinks after a refusal, as entries may hold more attributes than were counted.
    double page_share = gl_tuning().memory.max_share;

    // A resting view.
    struct Rest {
        SceneSelection lod;                 // as a moving view would draw it
        SceneSelection all;                 // all nodes in view that have been read; begins with `lod`
        std::size_t pages_read = 0;         // pages of nodes when `all` was selected
        bool begun = false;                 // the target holds `lod`, except chunks that cannot be loaded
        std::size_t added = 0;              // how many of `all.order` the target holds or were left out
        std::vector<std::size_t> left_out;  // nodes of these that could not be loaded
        std::uint64_t points = 0, nodes = 0;
        std::vector<std::uint64_t> points_of, hidden_of;  // for each item
        std::size_t held = 0;                             // how many of `lod.order` are kept in L1
        bool behind = false;  // it is drawn into `next`; the members below describe the picture that is shown
        std::uint64_t shown_points = 0, shown_nodes = 0;
        std::vector<std::uint64_t> shown_points_of, shown_hidden_of;
        double shown_error_px = 0;
    };
    std::optional<Rest> rest;

    // For a view that rests and has its picture: frames at sub-pixel offsets, whose mean is shown.
    struct Smoothing {
        unsigned asked = 1;              // RenderOptions::smooth_frames
        unsigned goal = 1;               // frames of the mean
        Finish finish;                   // finish of these frames
        unsigned frames = 0;             // frames that `sum` has; the first is the picture itself
        std::optional<Rest> unfinished;  // the next one, of which `next` has a part
    };
    std::optional<Smoothing> smoothing;
    ColourTarget sum{ColourTarget::sums};  // only while there is a smoothing

    void forget()
    {
        key.reset();
        rest.reset();
        smoothing.reset();
        kept.clear();
    }
};

}  // namespace pcm
