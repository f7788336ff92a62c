// Which chunks of a tree are read at once.
#pragma once

#include "pcm/tree/node.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// The most that one read of several chunks takes.
inline constexpr std::uint64_t most_read_together = std::uint64_t{1} << 20;

// Whether `next` follows `last` in a file, with a gap that is cheaper to read than to skip. False for no bytes.
bool follows(const Extent& last, const Extent& next);

// The chunks to be read together with the first one, of those at `extents`, which are in the order in which they are
// wanted: neighbours in its file of which each follows() the one before, within most_read_together. Numbers in
// `extents`, in the order of the file; the first one is among them.
std::vector<std::size_t> read_together(const std::vector<Extent>& extents);

}  // namespace pcm
