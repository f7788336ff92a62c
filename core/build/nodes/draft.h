// Nodes while a tree is built.
#pragma once

#include "pcm/tree/tree.h"

#include <array>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

namespace pcm {

// A node in the making.
struct Draft {
    std::array<Draft*, 2> children{nullptr, nullptr};
    NodePath path;
    Box3i box;  // around its own points
    std::uint32_t points = 0;
    std::uint16_t first_level = 0;
    std::vector<std::uint32_t> level_points;
    double spacing = 0;
    Extent extent;  // its chunk; file and offset are known once the chunk is written
};

// Owns drafts; they never move. add() may be called from any thread.
class DraftStore {
public:
    Draft* add(const NodePath& path)
    {
        const std::lock_guard lock(mutex_);
        drafts_.emplace_back();
        drafts_.back().path = path;
        return &drafts_.back();
    }

private:
    std::mutex mutex_;
    std::deque<Draft> drafts_;
};

}  // namespace pcm
