// The chunks of a tree with the values that units have given their points: encoded by the ranks of a team, a file for
// some nodes that follow one another.
#pragma once

#include "pcm/cluster/filter/unit_results.h"
#include "pcm/threads/team.h"
#include "pcm/threads/watch.h"
#include "pcm/update/tree_changes.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace pcm {

// Which columns of the results become which attributes; what the values are at last.
struct ChunkValues {
    std::vector<std::size_t> places;  // in the tree's schema, keyed by column of the results; further columns are none
    // Changes the values of some points, which have this place in the schema, before they are written; returns how many
    // were changed. Empty: nothing is. Any thread.
    std::function<std::uint64_t(const UnitResults::Part& part, std::vector<std::byte>& values)> finish;
    std::size_t finished = 0;
};

class ChunkJobs {
public:
    // `tree`: with the schema that the chunks are to have. `longer`: it has more attributes than the tree on disk.
    ChunkJobs(const JobFolder& jobs, const Tree& tree, bool longer, const UnitResults& results, ChunkValues values);

    // Collective. Progress goes from `begin` to `end`.
    void encode(Team& team, unsigned threads, Watch& watch, double begin, double end) const;
    // In rank 0, then: replaces the chunks, in the order of the nodes. Returns how many values were changed at last.
    std::uint64_t put(TreeChanges& changes, Watch& watch, double begin, double end) const;

private:
    void work(std::size_t job) const;
    Chunk chunk_of(NodeId node, std::uint64_t& hash_before, std::uint64_t& changed) const;
    std::size_t jobs() const { return first_.size() - 1; }

    const JobFolder& folder_;
    const Tree& tree_;
    const bool longer_;
    const UnitResults& results_;
    const ChunkValues values_;
    std::vector<NodeId> first_;  // first node of each job; then, the number of nodes
};

}  // namespace pcm
