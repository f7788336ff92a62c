// Where a build works, and what its stages share: limits, threads, progress and space on disk.
#pragma once

#include "pcm/build/bins/row.h"
#include "pcm/build/bins/scratch_file.h"
#include "pcm/system/progress.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>

namespace pcm {

struct Workspace {
    // `threads_asked` 0: one per processor. `progress` must outlive the workspace.
    Workspace(std::filesystem::path work_folder, std::uint64_t memory, std::uint32_t largest_chunk,
              unsigned threads_asked, const ProgressFunction& progress)
        : folder(std::move(work_folder)),
          memory_bytes(memory),
          chunk_points(largest_chunk),
          threads(thread_count(threads_asked)),
          watch(progress)
    {
    }
    Workspace(const Workspace&) = delete;

    const std::filesystem::path folder;  // folder of the scratch files
    const std::uint64_t memory_bytes;    // for the whole build
    const std::uint32_t chunk_points;    // maximum points per chunk
    const unsigned threads;
    Watch watch;
    ScratchSpace space;

    // Points per bin of a cloud of `points`: four chunks, or more where that would make more than about 2^18 bins. The
    // memory and the number of threads do not matter, because the bins shape the tree.
    std::uint64_t bin_points(std::uint64_t points) const
    {
        return std::max(points >> most_bins_bits, 4 * std::uint64_t(chunk_points));
    }
    // Size of the rows that a thread gathers on their way to bins, bytes. With what is being read and packed, all
    // threads together stay below a quarter of the memory and some 20 MiB.
    std::uint64_t writer_bytes() const { return memory_bytes / 32 * 7 / threads; }
    // How many of the threads work on bins of the size that a cloud of `points` has: as many as fit in half of the
    // memory, but one at least.
    unsigned bin_threads(const RowLayout& layout, std::uint64_t points) const
    {
        const std::uint64_t bin = bin_points(points) * point_bytes(layout);
        return static_cast<unsigned>(std::clamp<std::uint64_t>(memory_bytes / 2 / bin, 1, threads));
    }

private:
    static constexpr int most_bins_bits = 18;
    // Rows before and after the sort, coordinates and work space.
    static std::uint64_t point_bytes(const RowLayout& layout)
    {
        return 2 * layout.bytes + 3 * layout.coordinate_bytes + 32;
    }
};

}  // namespace pcm
