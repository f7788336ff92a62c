// The points of a tree that are nearest to one point: best first over nodes, then over blocks of 64 points.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/knn/held_chunks.h"
#include "pcm/tree/source_rounding.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace pcm {

struct Neighbour {
    NodeId node = no_node;
    std::uint32_t index = 0;  // in the node's chunk
    double squared_distance = 0;
    Vec3d position{};  // source coordinates
    double distance() const;
};

// Many searches in one tree, by one thread. Memory: up to 16 chunks in addition to the cache's. The order of results
// and ties are those of query/nearest.h.
class PointSearch {
public:
    // Points of the cloud at `level` (the whole cloud when absent), no farther than `max_distance`, in source units.
    PointSearch(L2Cache& cache, BlockCache& blocks, const std::optional<std::uint16_t>& level = {},
                double max_distance = std::numeric_limits<double>::infinity());
    // Nearest first. Throws what reading throws.
    void run(const Vec3d& q, std::size_t k, std::vector<Neighbour>& result);
    // Hands out all points within a distance (inclusive, at least; some that are farther, too), those of a block of a
    // node's chunk at a time: the points begin .. end - 1 of `node`. Throws what reading throws.
    using SeeBlock =
        std::function<void(const ChunkPositions& positions, NodeId node, std::uint32_t begin, std::uint32_t end)>;
    void within(const Vec3d& q, double distance, const SeeBlock& see);
    std::uint64_t compared() const { return compared_; }  // points, in all searches

private:
    using Ranked = std::pair<double, std::uint32_t>;

    bool may_hold(double square, NodeId id, std::size_t k) const;
    void queue_node(NodeId id, const Vec3d& q, std::size_t k);
    template <class F>
    void in_order(std::vector<Ranked>& ranked, NodeId id, std::size_t k, const F& f);
    void rank(const PointBlocks::Boxes& boxes, std::size_t begin, std::size_t end, NodeId id, const Vec3d& q,
              std::size_t k, std::vector<Ranked>& ranked);
    void search_chunk(NodeId id, const Vec3d& q, std::size_t k);
    void search_block(const HeldChunk& chunk, std::uint32_t block, const Vec3d& q, std::size_t k);

    HeldChunks chunks_;
    const SourceRounding rounding_;
    const double limit_;           // a square
    std::vector<Neighbour> best_;  // a heap, worst first
    std::vector<std::pair<double, NodeId>> nodes_;
    std::vector<Ranked> ranked_groups_, ranked_blocks_;
    std::vector<double> squares_;
    std::uint64_t compared_ = 0;
};

}  // namespace pcm
