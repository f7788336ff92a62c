// From bins of rows to the nodes of a tree: sort each bin, choose the points' levels, build the nodes and their chunks.
// Builds do this with checkpoints, updates without.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/build/bins/workspace.h"
#include "pcm/build/checkpoints.h"
#include "pcm/build/levels/level_sampler.h"
#include "pcm/build/nodes/data_files.h"
#include "pcm/build/nodes/draft.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

// How much of an interrupted build's work was used.
struct Resumed {
    enum class Stage { nothing, partitioned, sorted, levelled, committed };
    Stage stage = Stage::nothing;
    std::size_t done = 0, all = 0;  // sorted: bins; committed: parts of the tree (NodeJobs)
};

struct PartOptions {
    Sampling sampling = Sampling::poisson;
    std::uint32_t part = 0, generation = 1;  // as in ChunkIdentity
    Resumed resumed;  // stage `partitioned`: the bins are those of an interrupted build, whose checkpoints are used
};

struct Part {
    Draft* root = nullptr;  // in the store; null for a cloud without points
    std::vector<double> spacings;
    Resumed resumed;
};

// `work` must outlive the tasks of `checkpoints`. The levels are chosen next to `given` ones where there are any.
// Reports progress from 0.4 to 0.98 on the calling thread. Throws Error(cancelled), and Error(corrupt | truncated) with
// a path in work.folder when the checkpoints of an interrupted build do not match the files and cannot be ignored.
template <class Coord>
Part make_part(Bins<Coord>& bins, Workspace& work, const Ingested& cloud, const PartOptions& options,
               Checkpoints& checkpoints, DraftStore& drafts, DataFiles& files,
               std::optional<GivenLevels<Coord>> given = {});

extern template Part make_part(Bins<std::uint32_t>&, Workspace&, const Ingested&, const PartOptions&, Checkpoints&,
                               DraftStore&, DataFiles&, std::optional<GivenLevels<std::uint32_t>>);
extern template Part make_part(Bins<std::uint64_t>&, Workspace&, const Ingested&, const PartOptions&, Checkpoints&,
                               DraftStore&, DataFiles&, std::optional<GivenLevels<std::uint64_t>>);

}  // namespace pcm
