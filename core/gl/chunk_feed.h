// Brings the chunks that a view wants from L2 into L1: what is asked for, what has arrived, what cannot be had.
#pragma once

#include "pcm/gl/l1_cache.h"
#include "pcm/gl/vertex_format.h"
#include "pcm/point_cloud.h"
#include "pcm/view/level_of_detail.h"
#include "pcm/view/point_colours.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace pcm {

// One client of an L1, and of a cloud's L2. GL thread only, but for set_wake().
class ChunkFeed {
public:
    ChunkFeed(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1);
    ~ChunkFeed();
    ChunkFeed(const ChunkFeed&) = delete;
    ChunkFeed& operator=(const ChunkFeed&) = delete;

    // How many chunks may be on their way at a time. More would not come sooner, and what has arrived and waits for its
    // upload is pinned in L2.
    static constexpr std::size_t window_size = 32;

    L1Cache::Owner owner() const { return owner_; }
    const VertexEntry* find(NodeId node) const { return l1_->find(owner_, node); }
    static bool is_current(const VertexEntry* entry, const VertexFormat& format)
    {
        return entry && entry->format.serves(format);
    }

    // The first nodes in `wanted` that video memory lacks (or has in another format): those that are not `current`;
    // less what lies below a node that cannot be loaded, as it could not be drawn anyway.
    std::vector<NodeId> window_of(const DetailSelection& selection, const std::vector<bool>& current);
    // What a view will want later and video memory has not got: the loader has time for it only when little is missing
    // now.
    std::vector<NodeId> ahead_of(const DetailSelection& later, std::size_t missing_now) const;
    // Whether the node cannot be loaded for the time being.
    bool has_failed(NodeId node);

    // Takes what has come of the window from L2 and asks for the rest, and then for what is `ahead`.
    void load(const std::vector<NodeId>& window, const std::vector<NodeId>& ahead, const VertexFormat& format);
    // Puts what has come into L1, within so much time.
    Served upload(const std::vector<NodeId>& window, const VertexFormat& format, double budget_ms);
    // Whether something of the window is on its way.
    bool waits();
    // Why some of it cannot be loaded for the time being; empty when all can.
    std::string error() const { return failed_.empty() ? std::string() : error_; }

    // See DrawnCloud::set_wake().
    void set_wake(std::function<void()> wake);
    // Lets go of what has come and of what the L1 has.
    void release();

private:
    using Clock = std::chrono::steady_clock;

    // What loader threads leave for the next frame. Shared with the callbacks, so it outlives the feed if need be.
    struct Inbox {
        std::mutex mutex;
        std::set<NodeId> arrived;
        std::function<void()> wake;
        void put(NodeId node);
        std::set<NodeId> take();
    };
    // Where a node of the window stands on its way to video memory.
    struct Arrival {
        L2Cache::Handle chunk;  // pinned until it is uploaded or the view has no use for it
        unsigned lost = 0;      // times it had arrived and was dropped by L2 before it was found
    };

    ColumnSet columns_of(const VertexFormat& format) const;
    VertexAttributes attributes_of(const Chunk& chunk, const VertexFormat& format);
    void fail(NodeId node, std::string error);

    const std::shared_ptr<PointCloud> cloud_;
    const std::shared_ptr<L1Cache> l1_;
    L1Cache::Owner owner_;
    const std::shared_ptr<Inbox> inbox_ = std::make_shared<Inbox>();
    std::map<NodeId, Arrival> arrivals_;
    VertexFormat arrivals_format_;  // the columns that they hold are for this
    bool asked_last_ = false;
    std::map<NodeId, Clock::time_point> failed_;
    std::string error_;
    std::map<ColourSource, ColourScale> scales_;
    std::vector<std::uint8_t> rgba_;
    std::vector<float> radii_, normals_;
};

}  // namespace pcm
