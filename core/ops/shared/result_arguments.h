// Arguments of operations whose result is another cloud, made of a tree or of files.
#pragma once

#include "pcm/convert/open_cloud.h"
#include "pcm/filter/result_tree.h"
#include "pcm/ops/shared/reading_arguments.h"
#include "pcm/ops/shared/target_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/system/error.h"
#include "pcm/system/scratch_folder.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pcm::ops {

struct ResultArguments {
    ResultArguments();
    std::vector<std::string> inputs;
    TargetArguments target;
    WorkArguments work;
    std::uint32_t chunk_points = default_chunk_points;
    ReadingArguments reading;
    // The command takes files too; a dialog works on the tree of a layer.
    void declare_inputs(Arguments& arguments);
    void declare_target(Arguments& arguments);
    void declare_reading(Arguments& arguments);
};

// For a result that is always a new tree or file: output, chunk_points, overwrite.
struct NewCloudArguments {
    NewCloudArguments();
    std::string output;
    bool overwrite = false;
    std::uint32_t chunk_points = default_chunk_points;
    WorkArguments work;
    Argument& declare_output(Arguments& arguments);
    void declare_work(Arguments& arguments);
    // Without sampling.
    BuildOptions build_options(const Context& context) const;
};

// The tree that a filter reads: the input itself, or a temporary tree of several inputs or files, which is built by the
// constructor in a scratch folder next to the output (system/scratch_folder.h), and removed by the destructor. Or no
// tree: the points of files themselves, where the filter can do without.
class Sources {
public:
    // `choice`: where the result goes; `sampling`: the sampling of a temporary tree; `needs_no_tree`: whether the
    // filter takes such points of files as they come. Throws what open_cloud() and build_tree() throw, and
    // ArgumentError for a change in place of files.
    Sources(const ResultArguments& arguments, const TargetChoice& choice, Sampling sampling,
            const ProgressFunction& progress, const std::function<bool(const FileInfo&)>& needs_no_tree = {});
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
    // Reader of the files' points, to be read once; null where there is a tree.
    PointReader* points() const { return points_.get(); }
    // Calls `filter(points, names of the files, options)`.
    template <class FilterOfPoints>
    auto apply_to_points(const FilterOfPoints& filter) const
    {
        return filter(*points_, files_->names(), result_options());
    }
    // The head of the answer: the build's outcome with the seconds of all of it, and the notes of reading and build.
    void describe(Result& result, const BuildReport& report) const;

private:
    ResultOptions result_options() const;
    Error about_inputs(const Error& error) const;

    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    const ResultArguments& arguments_;
    const TargetChoice choice_;
    const ProgressFunction& progress_;
    std::filesystem::path path_;
    std::vector<std::string> notes_;
    std::string inputs_;                      // for users
    std::unique_ptr<ScratchFolder> scratch_;  // the folder of a temporary tree
    std::unique_ptr<CloudSources> files_;
    std::unique_ptr<PointReader> points_;  // reader of files_; null where there is a tree
};

}  // namespace pcm::ops
