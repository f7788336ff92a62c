#include "pcm/ops/shared/result_arguments.h"

#include "pcm/system/output_path.h"
#include "pcm/system/progress_part.h"
#include "pcm/system/renamed_error.h"
#include "pcm/system/seconds.h"

#include <algorithm>

namespace pcm::ops {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t usual_memory = std::uint64_t(1) << 30;
const char* const output_help =
    "The new tree's folder, by convention NAME.pct; on the command line also a file, by the extension: NAME.laz or "
    "NAME.ply";

}  // namespace

ResultArguments::ResultArguments() { work.memory = usual_memory; }

void ResultArguments::declare_inputs(Arguments& arguments)
{
    arguments.add("input", inputs)
        .as(ValueKind::cloud)
        .positional()
        .required()
        .script("Tree")
        .label("Tree folder")
        .help("A tree, or files, folders and trees, which are merged into one cloud");
}

void ResultArguments::declare_target(Arguments& arguments)
{
    const char* const group = "Output";
    target.declare_target(arguments, "");
    arguments.find("output")->group(group).help(output_help);
    arguments.find("in_place")->group(group).help("Replace the tree by the result, atomically");
    arguments.find("overwrite")->group(group);
    chunk_points_argument(arguments, chunk_points);
    arguments.find("chunk_points")->group(group);
    work.declare(arguments, least_build_memory);
}

void ResultArguments::declare_reading(Arguments& arguments)
{
    reading.declare(arguments, Face::command);
    reading.declare_ignore_crs(arguments, Face::command);
}

NewCloudArguments::NewCloudArguments() { work.memory = usual_memory; }

Argument& NewCloudArguments::declare_output(Arguments& arguments)
{
    return arguments.add("output", output).as(ValueKind::output_tree).label("Output folder").help(output_help);
}

void NewCloudArguments::declare_work(Arguments& arguments)
{
    arguments.add("overwrite", overwrite)
        .label("Overwrite")
        .help("Replace an existing tree of the output's name; on the command line also a file");
    work.declare(arguments, least_build_memory);
    chunk_points_argument(arguments, chunk_points);
}

BuildOptions NewCloudArguments::build_options(const Context& context) const
{
    BuildOptions options;
    options.memory_bytes = work.memory;
    options.threads = work.threads;
    options.chunk_points = chunk_points;
    options.overwrite = overwrite;
    options.progress = context.progress;
    return options;
}

Sources::Sources(const ResultArguments& arguments, const TargetChoice& choice, Sampling sampling,
                 const ProgressFunction& progress, const std::function<bool(const FileInfo&)>& needs_no_tree)
    : arguments_(arguments), choice_(choice), progress_(progress)
{
    const std::vector<std::string>& inputs = arguments.inputs;
    if (inputs.size() == 1 && (is_tree(inputs[0]) || is_tree_folder(tree_folder_of(inputs[0])))) {
        path_ = inputs[0];
        return;
    }
    if (choice.in_place) throw ArgumentError("--in-place: only a single tree can be replaced by the result");
    // Refuses what cannot be the output's name before the files are read.
    const fs::path output = result_place(choice.copy, choice.overwrite);
    inputs_ = inputs.size() == 1 ? inputs[0] : "the inputs";
    CloudOptions options;
    options.read = arguments.reading.get(arguments.work.threads);
    const std::vector<fs::path> paths(inputs.begin(), inputs.end());
    files_ = std::make_unique<CloudSources>(paths, options);
    std::unique_ptr<PointReader> cloud = files_->open();
    if (needs_no_tree && needs_no_tree(cloud->info())) {
        points_ = std::move(cloud);
        return;
    }
    BuildOptions build;
    build.memory_bytes = arguments.work.memory;
    build.threads = arguments.work.threads;
    build.sampling = sampling;
    build.progress = part_of(progress, 0, 0.5);
    scratch_ = std::make_unique<ScratchFolder>(output);
    path_ = scratch_->work() / "input.pct";
    try {
        notes_ = build_tree(*cloud, files_->names(), path_, build).notes;
    } catch (const Error& error) {
        throw renamed(error, path_, output);
    }
}

Sources::~Sources() = default;

Error Sources::about_inputs(const Error& error) const { return scratch_ ? renamed(error, path_, inputs_) : error; }

ResultOptions Sources::result_options() const
{
    ResultOptions options;
    options.target = choice_;
    options.memory_bytes = arguments_.work.memory;
    options.threads = arguments_.work.threads;
    options.chunk_points = arguments_.chunk_points;
    if (scratch_ || points_) options.sampling = Sampling::poisson;
    options.progress = scratch_ ? part_of(progress_, 0.5, 1) : progress_;
    return options;
}

void Sources::describe(Result& result, const BuildReport& report) const
{
    result.input = arguments_.inputs;
    result.output = choice_.in_place ? path_.string() : choice_.copy.string();
    result.makes = choice_.in_place ? Makes::changed : is_point_file_name(result.output) ? Makes::file : Makes::cloud;
    result.outcome = report.outcome;
    result.outcome.seconds = seconds_since(start_);
    result.notes = notes_;
    for (const std::string& note : report.notes)
        if (std::find(notes_.begin(), notes_.end(), note) == notes_.end()) result.notes.push_back(note);
}

}  // namespace pcm::ops
