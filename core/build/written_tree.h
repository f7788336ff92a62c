// The last files of a new tree: its index and what describes it.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/build/build_then.h"
#include "pcm/build/nodes/draft.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pcm {

struct WrittenTree {
    std::filesystem::path folder;  // has the data files
    std::filesystem::path output;  // the name that it will get, for messages
    const Draft* root = nullptr;   // null for a cloud without points
    std::vector<double> spacings;
    std::vector<std::uint64_t> data_files;  // size of each
    std::vector<std::string> sources;
    Sampling sampling = Sampling::poisson;
    const TreeInfo* like = nullptr;  // the tree whose points these are, if any
};

// Writes them durably, removes files of interrupted work on the tree, and fills the report's counts. Throws
// Error(corrupt) when points were lost on the way, and for points that differ from those of `like`.
void write_tree(const WrittenTree& tree, const Ingested& cloud, BuildReport& report);

// Runs `then` on the tree before it gets its name; warnings of it name `output` in place of `folder`.
void run_then(const WorkOnTree& then, const std::filesystem::path& folder, const std::filesystem::path& output,
              BuildReport& report);

}  // namespace pcm
