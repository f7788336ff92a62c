// What commands share whose result is another cloud: -o, --in-place, --overwrite, -m, -t, and inputs that are files.
#pragma once

#include "pcm/cli/common.h"
#include "pcm/cli/reading.h"
#include "pcm/filter/result_tree.h"
#include "pcm/system/error.h"
#include "pcm/system/scratch_folder.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pcm::cli {

class ResultArguments {
public:
    void add_to(Options& options);
    // Throws UsageError unless an output or --in-place was given.
    void check() const;

    std::string output;
    bool in_place = false, overwrite = false;
    std::uint64_t memory = std::uint64_t(1) << 30;
    unsigned threads = 0;
    std::uint32_t chunk_points = default_chunk_points;
};

// The tree that a filter reads: the input itself, or a temporary tree of several inputs or files, which is built by the
// constructor in a scratch folder beside the output (system/scratch_folder.h), and removed by the destructor.
class Sources {
public:
    // `sampling`: of a temporary tree. Throws what open_cloud() and build_tree() throw, and UsageError for a change in
    // place of files.
    Sources(const std::vector<std::string>& inputs, const ResultArguments& arguments, const ReadingOptions& reading,
            Sampling sampling, const ProgressFunction& progress);
    ~Sources();
    Sources(const Sources&) = delete;
    Sources& operator=(const Sources&) = delete;

    // Calls `filter(tree, options)`. Its errors name the inputs in place of a temporary tree.
    template <class FilterOfTree>
    auto apply(const FilterOfTree& filter) const
    {
        try {
            return filter(path_, result_options());
        } catch (const Error& error) {
            throw about_inputs(error);
        }
    }
    std::filesystem::path output() const;
    // Those of reading the files, and these.
    std::vector<std::string> notes(const std::vector<std::string>& more) const;
    double seconds() const;  // since the construction began

private:
    ResultOptions result_options() const;
    Error about_inputs(const Error& error) const;

    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    const ResultArguments& arguments_;
    const ProgressFunction& progress_;
    std::filesystem::path path_;
    std::vector<std::string> notes_;
    std::string inputs_;                      // for users
    std::unique_ptr<ScratchFolder> scratch_;  // of a temporary tree
};

}  // namespace pcm::cli
