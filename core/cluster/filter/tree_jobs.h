// What the jobs of operations on one tree have in common: which tree they are of, the error where it has changed, and
// how its nodes are divided among them.
#pragma once

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace pcm {

// The state of a tree, for the identity of its jobs.
inline void put_state(ByteWriter& out, const TreeInfo& info)
{
    out.put(info.generation);
    out.put(info.points);
    out.put(info.content_hash);
    out.put(info.bytes);
}

inline Error tree_has_changed(const std::filesystem::path& tree)
{
    return Error(ErrorCode::exists, tree, "another program has changed the tree meanwhile",
                 "start this again; nothing was written");
}

// The first node of each job; then, `nodes`. `points_of(node)`: its points.
template <class Number, class PointsOf>
std::vector<Number> divide_among_jobs(Number nodes, const PointsOf& points_of)
{
    // Chosen: some ten chunks of the usual size, a second of work, so that many ranks have jobs to the end.
    constexpr std::uint64_t points_of_a_job = 200'000;
    std::vector<Number> first;
    std::uint64_t points = points_of_a_job;
    for (Number node = 0; node < nodes; ++node) {
        if (points >= points_of_a_job) {
            first.push_back(node);
            points = 0;
        }
        points += points_of(node);
    }
    first.push_back(nodes);
    return first;
}

}  // namespace pcm
