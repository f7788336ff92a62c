#include "pcm/cli/result_options.h"

#include "pcm/convert/open_cloud.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/system/renamed_error.h"

#include <algorithm>

namespace pcm::cli {
namespace {

namespace fs = std::filesystem;

// The part of the progress from `begin` to `end`, for an operation that reports 0 to 1.
ProgressFunction part_of(const ProgressFunction& progress, double begin, double end)
{
    return [&progress, begin, end](ProgressUpdate update) {
        update.fraction = begin + (end - begin) * update.fraction;
        update.seconds_left = -1;
        return progress(update);
    };
}

}  // namespace

void ResultArguments::add_to(Options& options)
{
    const char* const group = "Output";
    const Option to =
        options
            .option("-o,--output", output,
                    "The new tree's folder, by convention NAME.pct; or a file, by the extension: NAME.laz, .ply, ...")
            .group(group);
    options.flag("--in-place", in_place, "Replace the tree by the result, atomically").excludes(to).group(group);
    options.flag("--overwrite", overwrite, "Replace an existing tree of the output's name").group(group);
    options.option("--chunk-points", chunk_points, "Maximum number of points per chunk (default 25000)").group(group);
    options.option("-m,--memory", memory, "Memory limit, e.g. 512M or 2G (default 1G)").bytes();
    options.option("-t,--threads", threads, "Threads (default: one per processor)");
}

void ResultArguments::check() const
{
    if (output.empty() && !in_place) throw UsageError("an output is needed: give -o, or --in-place");
}

Sources::Sources(const std::vector<std::string>& inputs, const ResultArguments& arguments,
                 const ReadingOptions& reading, Sampling sampling, const ProgressFunction& progress)
    : arguments_(arguments), progress_(progress)
{
    if (inputs.size() == 1 && (is_tree(inputs[0]) || is_tree_folder(tree_folder_of(inputs[0])))) {
        path_ = inputs[0];
        return;
    }
    if (arguments.in_place) throw UsageError("--in-place: only a single tree can be replaced by the result");
    // Refuses what cannot be the output's name before the files are read.
    const fs::path output = result_place(arguments.output, arguments.overwrite);
    inputs_ = inputs.size() == 1 ? inputs[0] : "the inputs";
    CloudOptions options;
    options.read = reading.get(arguments.threads);
    CloudSources sources({inputs.begin(), inputs.end()}, options);
    const auto cloud = sources.open();
    BuildOptions build;
    build.memory_bytes = arguments.memory;
    build.threads = arguments.threads;
    build.sampling = sampling;
    build.progress = part_of(progress, 0, 0.5);
    scratch_ = std::make_unique<ScratchFolder>(output);
    path_ = scratch_->work() / "input.pct";
    try {
        notes_ = build_tree(*cloud, sources.names(), path_, build).notes;
    } catch (const Error& error) {
        throw renamed(error, path_, output);
    }
}

Sources::~Sources() = default;

Error Sources::about_inputs(const Error& error) const { return scratch_ ? renamed(error, path_, inputs_) : error; }

ResultOptions Sources::result_options() const
{
    ResultOptions options;
    options.target = {arguments_.output, arguments_.in_place};
    options.overwrite = arguments_.overwrite;
    options.memory_bytes = arguments_.memory;
    options.threads = arguments_.threads;
    options.chunk_points = arguments_.chunk_points;
    if (scratch_) options.sampling = Sampling::poisson;
    options.progress = scratch_ ? part_of(progress_, 0.5, 1) : progress_;
    return options;
}

fs::path Sources::output() const { return arguments_.in_place ? path_ : fs::path(arguments_.output); }

std::vector<std::string> Sources::notes(const std::vector<std::string>& more) const
{
    std::vector<std::string> all = notes_;
    for (const std::string& note : more)
        if (std::find(all.begin(), all.end(), note) == all.end()) all.push_back(note);
    return all;
}

double Sources::seconds() const
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

}  // namespace pcm::cli
