// Moves the chunks that a view wants from L2 into L1: requests them, uploads loaded ones, remembers failures.
#pragma once

#include "pcm/gl/l1_cache.h"
#include "pcm/gl/point_sizes.h"
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

    // The most chunks in flight. More would not arrive sooner, and chunks that wait for their upload are pinned in L2.
    static constexpr std::size_t window_size = 32;

    L1Cache::Owner owner() const { return owner_; }
    const VertexEntry* find(NodeId node) const { return l1_->find(owner_, node); }
    static bool is_current(const VertexEntry* entry, const VertexFormat& format)
    {
        return entry && entry->format.serves(format);
    }

    // The first nodes of `wanted` that are not `current`: absent from video memory, or there in another format. Nodes
    // below one that cannot be loaded are left out, as they could not be drawn.
    std::vector<NodeId> window_of(const DetailSelection& selection, const std::vector<bool>& current);
    // The nodes that a view will want later and that are not in video memory; none while many are missing now.
    std::vector<NodeId> ahead_of(const DetailSelection& later, std::size_t missing_now) const;
    // Whether loading the node failed recently.
    bool has_failed(NodeId node);

    // Takes loaded chunks of the window from L2 and requests the others, then those of `ahead`.
    void load(const std::vector<NodeId>& window, const std::vector<NodeId>& ahead, const VertexFormat& format);
    // Uploads loaded chunks into L1 within the time budget.
    Served upload(const std::vector<NodeId>& window, const VertexFormat& format, double budget_ms);
    // Whether a chunk of the window is being loaded.
    bool waits();
    // Why a chunk cannot be loaded at present; empty when all can.
    std::string error() const { return failed_.empty() ? std::string() : error_; }

    // See DrawnCloud::set_wake().
    void set_wake(std::function<void()> wake);
    // Drops loaded chunks and the entries in L1.
    void release();

private:
    using Clock = std::chrono::steady_clock;

    // What loader threads leave for the next frame. Shared with the callbacks, which may outlive the feed.
    struct Inbox {
        std::mutex mutex;
        std::set<NodeId> arrived;
        std::function<void()> wake;
        void put(NodeId node);
        std::set<NodeId> take();
    };
    // The state of a node of the window on its way to video memory.
    struct Arrival {
        L2Cache::Handle chunk;  // pinned until it is uploaded or not wanted any more
        unsigned lost = 0;      // times that it arrived and L2 evicted it before it was found
    };

    ColumnSet columns_of(const VertexFormat& format) const;
    VertexAttributes attributes_of(NodeId node, const Chunk& chunk, const VertexFormat& format);
    void find_radii(NodeId node, const Chunk& chunk);
    void fail(NodeId node, std::string error);

    const std::shared_ptr<PointCloud> cloud_;
    const std::shared_ptr<L1Cache> l1_;
    L1Cache::Owner owner_;
    const std::shared_ptr<Inbox> inbox_ = std::make_shared<Inbox>();
    std::map<NodeId, Arrival> arrivals_;
    VertexFormat arrivals_format_;  // the columns that they hold
    bool asked_last_ = false;
    std::map<NodeId, Clock::time_point> failed_;
    std::string error_;
    std::map<ColourSource, ColourScale> scales_;
    std::vector<std::uint8_t> rgba_;
    std::vector<float> radii_, normals_;
    std::optional<PointSizes> sizes_;  // when first needed
};

}  // namespace pcm
