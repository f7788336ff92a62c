#include "pcm/ops/shared/chain.h"

#include "pcm/convert/convert.h"
#include "pcm/filter/result_tree.h"
#include "pcm/io/pipe/require_points.h"
#include "pcm/ops/shared/reading_arguments.h"
#include "pcm/ops/shared/step.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/system/renamed_error.h"
#include "pcm/system/scratch_folder.h"
#include "pcm/tree/tree.h"

#include <algorithm>
#include <utility>

namespace pcm::ops {
namespace {

namespace fs = std::filesystem;

bool is_any_tree(const std::string& path) { return is_tree(path) || is_tree_folder(tree_folder_of(path)); }

bool is_file_output(const fs::path& path)
{
    std::error_code ignored;
    return is_point_file_name(path) && !fs::is_directory(path, ignored);
}

}  // namespace

Chain::Chain(ChainOptions options, std::vector<Link> links) : options_(std::move(options)), links_(std::move(links)) {}
Chain::~Chain() = default;

bool Chain::is_file() const { return is_file_output(place_); }

std::vector<Result> Chain::run(const Context& context)
{
    CloudSources sources({options_.inputs.begin(), options_.inputs.end()}, options_.reading);
    place_ = result_place(options_.output, options_.overwrite);
    if (sources.has(place_))
        throw Error(ErrorCode::invalid_argument, options_.output, "the output is one of the inputs",
                    "give the result another name");
    scratch_ = std::make_unique<ScratchFolder>(place_);
    summary_.input = options_.inputs;
    summary_.output = options_.output;
    summary_.makes = is_file() ? Makes::file : Makes::cloud;
    take_inputs(sources, options_.reading.selection.chooses_points(), context);
    std::vector<Result> answers;
    for (std::size_t i = 0; i < links_.size(); ++i) answers.push_back(run_link(i, context));
    if (!written_) write_file(context);
    scratch_.reset();
    return answers;
}

// The part of the progress of one of all that is done: reading, the operations, writing.
ProgressFunction Chain::part(const Context& context, std::size_t i, const std::string& name) const
{
    const double parts = static_cast<double>(links_.size() + 2);
    return [&context, i, name, parts](const ProgressUpdate& update) {
        if (!context.progress) return true;
        const std::string stage = name + (name.empty() ? "" : ": ") + std::string(update.stage);
        return context.progress({stage, (static_cast<double>(i) + update.fraction) / parts, -1});
    };
}

// One tree is read where it is; anything else becomes a tree in the scratch folder.
void Chain::take_inputs(CloudSources& sources, bool selected, const Context& context)
{
    const std::vector<std::string>& inputs = options_.inputs;
    summary_.values["points_skipped"] = 0;
    put_skipped(summary_, {});
    summary_.notes = sources.notes();
    summary_.accuracy = exact_answer();
    if (inputs.size() == 1 && is_any_tree(inputs[0]) && !selected) {
        tree_ = inputs[0];
        summary_.outcome.points_in = Tree::open(tree_)->info().points;
        return;
    }
    auto cloud = sources.open();
    if (selected) cloud = require_points(std::move(cloud), [&sources] { return sources.bounds(); });
    BuildOptions build;
    build.memory_bytes = options_.memory_bytes;
    build.threads = options_.threads;
    build.progress = part(context, 0, "");
    const fs::path folder = next_folder();
    try {
        const BuildReport report = build_tree(*cloud, sources.names(), folder, build);
        summary_.outcome = report.outcome;
        summary_.accuracy = rounded_positions(report.outcome.error);
        summary_.values["points_skipped"] = report.points_skipped;
        put_skipped(summary_, report.skipped);
        summary_.notes.insert(summary_.notes.end(), report.notes.begin(), report.notes.end());
    } catch (const Error& error) {
        throw renamed(error, folder, place_);
    }
    summary_.outcome.points_in = summary_.outcome.points_out;
    tree_ = folder;
    is_scratch_ = true;
}

fs::path Chain::next_folder() { return scratch_->work() / (std::to_string(folders_++) + tree_extension); }

// Whether the levels of an operation's tree are those of the output: no later one makes new ones.
bool Chain::keeps_levels(std::size_t i) const
{
    return !is_file() && std::none_of(links_.begin() + static_cast<std::ptrdiff_t>(i) + 1, links_.end(),
                                      [](const Link& link) { return writes_new_cloud(*link.operation); });
}

// Where an operation reads and writes. The last one writes the output, if it can.
void Chain::connect(const Link& link, bool last)
{
    Arguments& arguments = link.operation->arguments();
    Argument* const output = output_of_step(*link.operation);
    const bool anew = writes_new_cloud(*link.operation), to_place = last && output && (anew || !is_file());
    if (!to_place && !anew && !is_scratch_) copy_tree();
    input_of_step(*link.operation).set({tree_.string()}, "input");
    if (to_place || anew) {
        target_ = to_place ? place_ : next_folder();
        output->set({target_.string()}, "output");
        written_ = to_place;
        if (Argument* const over = arguments.find("overwrite"); over && to_place) over->set(options_.overwrite);
        return;
    }
    target_ = tree_;
    if (output && output->is_given()) output->set({""}, "output");
    if (Argument* const in_place = arguments.find("in_place"); in_place && in_place->is_in(Face::command))
        in_place->set(true);
}

// A tree of the user's is not changed: a copy of it is, which shares its data where the file system allows.
void Chain::copy_tree()
{
    struct Copied {
        Outcome outcome;
    };
    const fs::path folder = next_folder();
    UpdateTarget(tree_, {folder, false, false}).update([](const fs::path&) { return Copied(); });
    tree_ = folder;
    is_scratch_ = true;
}

Result Chain::run_link(std::size_t i, const Context& context)
{
    const Link& link = links_[i];
    const std::string before = link.name.empty() ? "" : link.name + ": ";
    Context own;
    own.progress = part(context, i + 1, link.name.empty() ? "" : link.row->name);
    own.keeps_levels = keeps_levels(i);
    own.gpu_radii = [](const GpuRadiiRequest&) -> Result {
        throw ArgumentError("device=gpu: a chain, and what is made of files, is computed on the processor");
    };
    Result answer;
    try {
        connect(link, i + 1 == links_.size());
        answer = link.operation->run(own);
    } catch (const Error& error) {
        throw about(error, link);
    } catch (const ArgumentError& error) {
        throw ArgumentError(before + error.what());
    }
    if (answer.makes == Makes::nothing)
        throw ArgumentError(before + "this only counts, and an output is to be written");
    if (is_scratch_ && target_ != tree_) {
        std::error_code ignored;
        fs::remove_all(tree_, ignored);  // at the latest the scratch folder goes
    }
    add_outcome(answer);
    for (std::string& line : answer.lines) line = renamed(std::move(line), target_, place_);
    tree_ = target_;
    is_scratch_ = true;
    return answer;
}

void Chain::add_outcome(const Result& answer)
{
    const bool is_tree = !written_ || !is_file();
    summary_.outcome.points_out = is_tree ? Tree::open(target_)->info().points : answer.outcome.points_out;
}

Error Chain::about(const Error& error, const Link& link) const
{
    const std::string inputs = options_.inputs.size() == 1 ? options_.inputs[0] : "the inputs";
    const auto shown = [&](std::string text) {
        text = renamed(std::move(text), tree_, inputs);
        return renamed(std::move(text), scratch_->work(), place_);
    };
    return Error(error.code(), shown(error.path().string()),
                 (link.name.empty() ? "" : link.name + ": ") + shown(text_alone(error)), error.hint());
}

// A tree whose last operation wrote no file.
void Chain::write_file(const Context& context)
{
    ConvertOptions options;
    options.memory_bytes = options_.memory_bytes;
    options.threads = options.write.threads = options_.threads;
    options.overwrite = options_.overwrite;
    options.progress = part(context, links_.size() + 1, "");
    try {
        const ConvertReport report = pcm::convert({tree_}, place_, options);
        Outcome& outcome = summary_.outcome;
        outcome.points_out = report.outcome.points_out;
        summary_.accuracy = of_steps({*summary_.accuracy, rounded_positions(report.outcome.error)});
        outcome.warnings.insert(outcome.warnings.end(), report.outcome.warnings.begin(), report.outcome.warnings.end());
        summary_.notes.insert(summary_.notes.end(), report.notes.begin(), report.notes.end());
    } catch (const Error& error) {
        throw renamed(error, tree_, place_);
    }
}

namespace {

// The answer of the one operation, about all that was done.
Result whole(Result answer, const Result& all)
{
    answer.input = all.input;
    answer.output = all.output;
    answer.makes = all.makes;
    answer.notes.insert(answer.notes.begin(), all.notes.begin(), all.notes.end());
    answer.outcome.points_in = all.outcome.points_in;
    answer.outcome.points_out = all.outcome.points_out;
    answer.accuracy = of_steps({*all.accuracy, *answer.accuracy});
    std::vector<std::string>& warnings = answer.outcome.warnings;
    warnings.insert(warnings.end(), all.outcome.warnings.begin(), all.outcome.warnings.end());
    return answer;
}

}  // namespace

Result run_on_files_too(const Row& row, Operation& operation, const Context& context)
{
    if (row.step.empty() || input_of_step(operation).kind() == ValueKind::cloud) return operation.run(context);
    const Arguments& arguments = operation.arguments();
    ChainOptions options;
    options.inputs = {input_of_step(operation).text()};
    if (const Argument* const output = output_of_step(operation)) options.output = output->text();
    std::error_code ignored;
    const bool from_file = !is_any_tree(options.inputs[0]) && fs::exists(options.inputs[0], ignored),
               to_file = !options.output.empty() && is_file_output(options.output) && !writes_new_cloud(operation);
    if (!from_file && !to_file) return operation.run(context);
    if (context.team)
        throw Error(ErrorCode::unsupported, from_file ? options.inputs[0] : options.output,
                    "several processes read and write trees here, not files",
                    from_file ? "make it a tree first: pcmlab-mpi build"
                              : "name a tree to write, NAME.pct, and convert it afterwards");
    if (!output_of_step(operation))
        throw Error(ErrorCode::invalid_argument, options.inputs[0], "this is not a tree, and files are not changed",
                    std::string("write a changed copy: pcmlab run FILE --") + row.name + " ... -o COPY");
    if (options.output.empty())
        throw ArgumentError("no output is given: " + options.inputs[0] + " is not a tree, so give --output " +
                            "NAME, a file or a tree to write");
    if (const Argument* const in_place = arguments.find("in_place");
        in_place && in_place->is_in(context.face) && in_place->is_given())
        throw ArgumentError("give either --output or --in-place, not both");
    if (const Argument* const memory = arguments.find("memory")) options.memory_bytes = memory->whole();
    if (const Argument* const threads = arguments.find("threads"))
        options.threads = static_cast<unsigned>(threads->whole());
    if (const Argument* const overwrite = arguments.find("overwrite")) options.overwrite = overwrite->is_given();
    const Meter meter;
    Chain chain(options, {{&row, &operation, ""}});
    Result answer = whole(chain.run(context).front(), chain.summary());
    meter.put_into(answer);
    return answer;
}

}  // namespace pcm::ops
