// What a Picture and a DrawnCloud are made of; renderer.cpp works on them.
#pragma once

#include "pcm/gl/chunk_feed.h"
#include "pcm/gl/frame_budget.h"
#include "pcm/gl/frame_clock.h"
#include "pcm/gl/render_target.h"
#include "pcm/gl/renderer.h"

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
    std::uint64_t serial = 0;  // no other cloud of the process has it
};

// What must be equal for a picture to be drawn further.
struct PictureKey {
    struct Shown {
        std::uint64_t cloud;
        Vec3d origin;
        Matrix4d placement;
        CloudStyle style;
        bool operator==(const Shown& o) const
        {
            return cloud == o.cloud && origin == o.origin && placement == o.placement && style == o.style;
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
    // Whether a point costs the same to draw.
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
    RenderTarget next;    // what a resting view is drawn into while `target` shows larger splats than it will have
    RenderTarget resolved;
    unsigned asked_samples = 1;
    FrameClock clock;
    FrameBudget budget;
    std::optional<PictureKey> key;
    std::vector<Camera> views;  // of the items, in the latest frame
    unsigned unmeasured = 2;    // so many frames from now on pay for the driver's compilation and tell nothing

    std::set<std::pair<std::uint64_t, NodeId>> kept;  // (cloud, node) drawn in the latest frame of a moving view

    // Of the video memory that the clouds can have, this share holds what a moving view draws; what only a resting view
    // needs streams through the rest. Smaller after a refusal, as entries may hold attributes that were not reckoned
    // with.
    double page_share = most_page_share;
    static constexpr double most_page_share = 0.75;

    // A view that rests.
    struct Rest {
        SceneSelection lod;                 // what a moving view would draw
        SceneSelection all;                 // everything in view; begins with `lod`
        bool begun = false;                 // the target holds `lod`, as far as it can be loaded
        std::size_t added = 0;              // of `all.order`, that the target holds or that were left out
        std::vector<std::size_t> left_out;  // of these: could not be loaded
        std::uint64_t points = 0, nodes = 0;
        std::vector<std::uint64_t> points_of;  // of each item
        std::size_t held = 0;                  // of `lod.order`, that L1 is asked to hold on to
        bool behind = false;                   // it is drawn into `next`, and what is shown is what follows
        std::uint64_t shown_points = 0, shown_nodes = 0;
        std::vector<std::uint64_t> shown_points_of;
        double shown_error_px = 0;
    };
    std::optional<Rest> rest;

    void forget()
    {
        key.reset();
        rest.reset();
        kept.clear();
    }
};

}  // namespace pcm
