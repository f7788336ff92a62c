// How the chunks of a tree divide among their columns, as far as headers were read. From that follows how much of the
// next chunk is worth reading at once, before its header is known.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/tree/node.h"

#include <cstdint>
#include <mutex>
#include <vector>

namespace pcm {

struct BpcHeader;

// Any number of threads.
class ColumnShares {
public:
    // The most that is read before the header is known.
    static constexpr std::uint64_t most_at_first = std::uint64_t{1} << 20;

    void learn(const BpcHeader& header);

    // Whether these columns are so much of a chunk that all of it is read at once. True while nothing is known.
    bool are_most(const ColumnSet& columns) const;
    // Bytes to read from the chunk's beginning: all up to the last of these columns where they are most of that, else
    // the header.
    std::uint64_t at_first(const Extent& extent, const ColumnSet& columns) const;

private:
    struct Sum {
        double wanted = 0;  // bytes of the columns
        double end = 0;     // end of the last of them
    };
    Sum sum(const ColumnSet& columns) const;

    mutable std::mutex mutex_;
    // Shares of a chunk's bytes without its header: positions, sizes, then the attributes of the schema.
    struct Share {
        double bytes = 0, end = 0;
    };
    std::vector<Share> shares_;
};

}  // namespace pcm
