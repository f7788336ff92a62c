// Moves the chunks that a view wants from L2 into L1: requests them, uploads loaded ones, remembers failures. Vertices
// are made by the cache's loader threads, so that the GL thread copies them and no more.
#pragma once

#include "pcm/gl/draw/cloud_facts.h"
#include "pcm/gl/draw/vertex_maker.h"
#include "pcm/gl/l1/chunk_filter.h"
#include "pcm/gl/l1/l1_cache.h"
#include "pcm/gl/l1/vertex_format.h"
#include "pcm/point_cloud.h"
#include "pcm/query/point_set.h"
#include "pcm/view/level_of_detail.h"
#include "pcm/view/point_colours.h"
#include "pcm/view/point_sizes.h"

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

    L1Cache::Owner owner() const { return owner_; }
    const VertexEntry* find(NodeId node) const { return l1_->find(owner_, node); }
    // Whether the node's entry, which may be null, has what this format needs, and the selected points of now.
    bool is_current(NodeId node, const VertexEntry* entry, const VertexFormat& format)
    {
        return entry && entry->format.serves(format) && entry->selection == selection_of(node);
    }

    // The points that are shown in another colour from now on; null: none. They belong to the cloud's tree.
    void select(std::shared_ptr<const PointSet> points);
    const std::shared_ptr<const PointSet>& selected() const { return selected_; }

    // The first nodes of `wanted` that are not `current`: absent from video memory, or there in another format. Nodes
    // below one that cannot be loaded are left out, as they could not be drawn.
    std::vector<NodeId> window_of(const DetailSelection& selection, const std::vector<bool>& current);
    // The nodes that a view will want later and that are not in video memory; none while many are missing now.
    std::vector<NodeId> ahead_of(const DetailSelection& later, std::size_t missing_now) const;
    // Whether loading the node failed recently.
    bool has_failed(NodeId node) const { return failed_.count(node) != 0; }

    // Begins a frame: what was asked of fact_of() before counts no more, and failures of some time ago are forgotten.
    void begin_frame();
    // What the colours of a usable style depend on as a whole; null for a style without such a fact, and while it is
    // not known: nothing is uploaded then.
    const CloudFact* fact_of(const CloudStyle& usable);
    // The format of a usable style, for points that all clips leave. `notice` is extended by the conditions that do not
    // apply to this cloud.
    VertexFormat format_of(const CloudStyle& usable, const std::vector<Clip>& clips, std::string& notice);
    // The classes among the points that were uploaded with colours by class.
    const ClassSet& classes() const { return classes_; }

    // Takes the chunks of the window whose vertices have been made and requests the others, then those of `ahead`,
    // whose vertices are made too and kept, so that they can be uploaded in the frame that wants them.
    void load(const std::vector<NodeId>& window, const std::vector<NodeId>& ahead, const VertexFormat& format);
    // Uploads vertices that have been made into L1 within the time budget.
    Served upload(const std::vector<NodeId>& window, const VertexFormat& format, double budget_ms);
    // Whether a chunk of the window is being loaded, or one that a fact needs.
    bool waits();
    // Whether a fact that this frame asked for will be known later.
    bool awaits_facts();
    // Why a chunk cannot be loaded at present; empty when all can.
    std::string error() const { return failed_.empty() ? std::string() : error_; }
    // Seconds until a chunk that could not be loaded is loaded by a frame that wants it; 0: there is none.
    double seconds_to_retry() const;

    // See DrawnCloud::set_wake().
    void set_wake(std::function<void()> wake);
    // Drops loaded chunks and the entries in L1.
    void release();

private:
    using Clock = std::chrono::steady_clock;

    // What has come of a requested chunk: nothing, where it was only to be loaded, or L2 evicted it at once.
    struct Delivery {
        std::shared_ptr<const VertexMaker> maker;  // null: it was only to be loaded
        std::optional<MadeVertices> made;
        std::string error;      // why they could not be made
        L2Cache::Handle chunk;  // one that was only to be loaded stays until the next frame has looked for it
    };
    // What loader threads leave for the next frame. Shared with the callbacks, which may outlive the feed.
    struct Inbox {
        std::mutex mutex;
        std::map<NodeId, Delivery> arrived;
        std::set<NodeId> making;
        std::set<NodeId> awaited;  // nodes of these whose arrival wakes the owner
        std::function<void()> wake;
        bool woken = false;  // since the latest take()
        // Makes the vertices, unless they are there or another thread makes some. On a loader thread.
        void make(NodeId node, const std::shared_ptr<const VertexMaker>& maker, L2Cache& cache, bool silent);
        void put(NodeId node, Delivery delivery, bool silent);
        std::map<NodeId, Delivery> take();

    private:
        bool begin(NodeId node, const VertexMaker* maker, bool silent);
        void call_wake();
    };
    // The state of a node of the window on its way to video memory.
    struct Arrival {
        std::optional<MadeVertices> made;  // the work of maker_
        bool loaded = false;               // and waits for the facts that vertices need
        unsigned lost = 0;                 // times that it arrived and L2 evicted it before it was found
    };

    // The attribute that colours are made from.
    AttributePlace colour_place_of(const VertexFormat& format) const;
    VertexRecipe recipe_of(const VertexFormat& format);
    // Makes another maker_ where what vertices are made by has changed; arrivals of the former are dropped.
    void renew_maker(const VertexFormat& format);
    void request_facts(const std::map<NodeId, Delivery>& arrived, std::vector<ChunkRequest>& list);
    void receive(NodeId node, Delivery delivery);
    static Delivery loaded_only(NodeId node, L2Cache& cache);
    void request(std::vector<ChunkRequest> list, std::set<NodeId> to_make, std::set<NodeId> silent);
    void fail(NodeId node, std::string error);
    std::uint64_t selection_of(NodeId node);

    const std::shared_ptr<PointCloud> cloud_;
    const std::shared_ptr<L1Cache> l1_;
    L1Cache::Owner owner_;
    const std::shared_ptr<Inbox> inbox_ = std::make_shared<Inbox>();
    std::map<NodeId, Arrival> arrivals_;
    std::map<NodeId, std::optional<MadeVertices>> ahead_;  // nodes that will be wanted; absent until they are made
    std::shared_ptr<const VertexMaker> maker_;             // maker of vertices that are wanted now; null: none yet
    bool asked_last_ = false;
    std::map<NodeId, Clock::time_point> failed_;
    std::string error_;
    CloudFacts facts_;
    std::map<std::string, std::uint32_t> filter_numbers_;      // keyed by the conditions' text
    std::vector<std::shared_ptr<const ChunkFilter>> filters_;  // index: number - 1
    std::vector<AttributePlace> attributes_;  // attributes that colours were made from; index: number - 1
    ClassSet classes_;
    std::uint32_t classes_filter_ = 0;         // number of the filter that the points of these meet
    std::shared_ptr<const PointSizes> sizes_;  // when first needed
    std::shared_ptr<const PointSet> selected_;
    std::vector<std::optional<std::uint64_t>> selections_;  // for each node, once it was asked for
};

}  // namespace pcm
