// What the stages of a build have in common, and what they tell each other.
#pragma once

#include "pcm/build/bins/observed.h"
#include "pcm/build/bins/scratch.h"
#include "pcm/build/bins/top_tree.h"
#include "pcm/build/builder.h"
#include "pcm/build/nodes/node_builder.h"
#include "pcm/cloud/metadata.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace pcm {

inline constexpr const char* scratch_file_name = "scratch.tmp";

struct BuildState {
    BuildState(const BuildOptions& build_options, std::filesystem::path work_folder)
        : options(build_options),
          threads(thread_count(options.threads)),
          folder(std::move(work_folder)),
          watch(options.progress)
    {
    }
    BuildState(const BuildState&) = delete;

    const BuildOptions& options;
    const unsigned threads;
    const std::filesystem::path folder;  // where the build works
    Watch watch;
    ScratchSpace space;

    const TreeInfo* like = nullptr;  // a tree whose grid and width of coordinates are to be taken

    // What reading finds.
    NodeBuilderOptions nodes;
    ScalarType position_type = ScalarType::f64;
    Observed observed;
    std::uint64_t points_in = 0, points_skipped = 0;
    std::vector<Metadata> metadata;
    std::vector<std::string> notes;

    // Points of a bin. It must not depend on the number of threads, or the tree would: sixteen bins at work fill half
    // of the memory.
    std::uint64_t bin_points(std::size_t row_bytes, std::size_t coordinate_bytes) const
    {
        return std::max(options.memory_bytes / 2 / 16 / point_bytes(row_bytes, coordinate_bytes),
                        2 * std::uint64_t(options.chunk_points));
    }
    // How many of the threads work on bins: fewer where a bin of two chunks is more than that.
    unsigned bin_threads() const
    {
        const std::size_t row = nodes.layout.bytes, coordinate = nodes.layout.coordinate_bytes;
        const std::uint64_t bin = bin_points(row, coordinate) * point_bytes(row, coordinate);
        return static_cast<unsigned>(std::clamp<std::uint64_t>(options.memory_bytes / 2 / bin, 1, threads));
    }

private:
    // Rows before and after the sort, coordinates and work space.
    static std::uint64_t point_bytes(std::size_t row_bytes, std::size_t coordinate_bytes)
    {
        return 2 * row_bytes + 3 * coordinate_bytes + 32;
    }
};

// The rows of a cloud, distributed to bins on disk; and the cuts between the bins.
template <class Coord>
struct Bins {
    TopTree<Coord> top;
    std::shared_ptr<Scratch> scratch;
};
using AnyBins = std::variant<Bins<std::uint32_t>, Bins<std::uint64_t>>;

}  // namespace pcm
