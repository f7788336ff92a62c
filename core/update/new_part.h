// The nodes of points that join a tree, as a part of their own.
#pragma once

#include "pcm/build/build_state.h"
#include "pcm/build/nodes/data_files.h"
#include "pcm/build/levels/level_sampler.h"

#include <optional>

namespace pcm {

// Sorts the bins, chooses the points' levels, beside `given` ones where there are any, and makes the nodes. Sets the
// state's spacings. Returns the root.
template <class Coord>
Draft* make_part(Bins<Coord>& bins, BuildState& state, DraftStore& drafts, DataFiles& files,
                 std::optional<GivenLevels<Coord>> given);

extern template Draft* make_part(Bins<std::uint32_t>&, BuildState&, DraftStore&, DataFiles&,
                                 std::optional<GivenLevels<std::uint32_t>>);
extern template Draft* make_part(Bins<std::uint64_t>&, BuildState&, DraftStore&, DataFiles&,
                                 std::optional<GivenLevels<std::uint64_t>>);

}  // namespace pcm
