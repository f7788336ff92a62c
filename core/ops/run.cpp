// A chain of operations: files, folders or trees go in, one tree or file comes out.
#include "pcm/convert/open_cloud.h"
#include "pcm/filter/result_tree.h"
#include "pcm/io/pipe/require_points.h"
#include "pcm/ops/shared/reading_arguments.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/shared/step.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/system/peak_memory.h"
#include "pcm/system/renamed_error.h"
#include "pcm/system/scratch_folder.h"
#include "pcm/system/text.h"
#include "pcm/tree/tree.h"

#include <algorithm>
#include <chrono>

namespace pcm::ops {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t chain_memory = std::uint64_t(1) << 30;

// A step that is ready to run.
struct Link {
    const Row* row;
    std::unique_ptr<Operation> operation;
    std::string name;  // for people: "step 2, subsample 0.05"
};

// The text of an error without its path and its hint, which stand around it.
std::string text_alone(const Error& error)
{
    std::string text = without_path(error);
    if (const std::string hint = " (" + error.hint() + ")"; !error.hint().empty() && text.size() > hint.size())
        text.erase(text.size() - hint.size());
    return text;
}

class Run : public Operation {
public:
    Run()
    {
        arguments_.add("input", inputs_)
            .as(ValueKind::inputs)
            .positional()
            .required()
            .help("Files, folders with their sub-folders, or trees, merged into one cloud");
        arguments_.add("output", output_)
            .letter('o')
            .as(ValueKind::output_tree)
            .required()
            .help("What is written, by its extension: " + std::string(tree_extension) + " for a tree; " +
                  writable_text());
        arguments_.add("overwrite", overwrite_).help("Replace an existing output; never an input");
        work_.memory = chain_memory;
        work_.declare(arguments_, least_build_memory);
        declare_steps();
        region_.declare(arguments_, "Points of the inputs to begin with (default: all)");
        reading_.declare(arguments_);
        reading_.declare_ignore_crs(arguments_);
    }

    Result run(const Context& context) override
    {
        const auto start = std::chrono::steady_clock::now();
        links_ = links();
        CloudOptions reading;
        reading.read = reading_.get(work_.threads);
        reading.selection = region_.get();
        CloudSources sources({inputs_.begin(), inputs_.end()}, reading);
        place_ = result_place(output_, overwrite_);
        if (sources.has(place_))
            throw Error(ErrorCode::invalid_argument, output_, "the output is one of the inputs",
                        "give the result another name");
        scratch_ = std::make_unique<ScratchFolder>(place_);
        Result result;
        result.input = inputs_;
        result.output = output_;
        result.makes = is_file() ? Makes::file : Makes::cloud;
        result.values["steps"] = Json::array();
        take_inputs(sources, reading.selection.chooses_points(), context, result);
        for (std::size_t i = 0; i < links_.size(); ++i) run_link(i, context, result);
        if (!written_) write_file(context, result);
        scratch_.reset();
        result.outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        result.print("%s: %s points of %s in %s steps, %.1f s, peak memory %s", output_.c_str(),
                     grouped(result.outcome.points_out).c_str(), grouped(result.outcome.points_in).c_str(),
                     grouped(links_.size()).c_str(), result.outcome.seconds, bytes_text(peak_memory_bytes()).c_str());
        return result;
    }

private:
    void declare_steps()
    {
        for (const Row& row : operations()) {
            if (row.step.empty()) continue;
            arguments_.add(row.name, steps_)
                .group("Steps, done in the order in which they are given; \"--outliers 16,factor=3 --normals 8,radii\"")
                .help(step_arguments(row) + ", then NAME=VALUE and flags: " + row.help);
        }
    }

    bool is_file() const { return is_point_file_name(place_) && !fs::is_directory(place_); }
    bool is_last(std::size_t i) const { return i + 1 == links_.size(); }

    // Everything that is wrong with the steps as they are written comes before any work.
    std::vector<Link> links() const
    {
        if (steps_.empty()) {
            std::string names;
            for (const Row& row : operations())
                if (!row.step.empty()) names += (names.empty() ? "--" : ", --") + std::string(row.name);
            throw ArgumentError("no step is given: " + names + "; without a step, convert does it");
        }
        std::vector<Link> links;
        for (std::size_t i = 0; i < steps_.size(); ++i) {
            const Row& row = *find_operation(steps_[i].operation);
            Link link{&row, row.make(), "step " + std::to_string(i + 1) + ", " + row.name + " " + steps_[i].values};
            try {
                set_step(row, *link.operation, steps_[i].values);
                limit(*link.operation);
            } catch (const ArgumentError& error) {
                throw ArgumentError(link.name + ": " + error.what());
            }
            links.push_back(std::move(link));
        }
        return links;
    }

    // The limits of the chain are those of each step that has none of its own.
    void limit(Operation& operation) const
    {
        const std::pair<const char*, std::uint64_t> limits[] = {{"memory", work_.memory}, {"threads", work_.threads}};
        for (const auto& [key, value] : limits)
            if (Argument* const argument = operation.arguments().find(key); argument && !argument->is_given())
                argument->set({std::to_string(value)}, key);
    }

    // The part of the progress of one of all that is done: reading, the steps, writing.
    ProgressFunction part(const Context& context, std::size_t i, const std::string& name) const
    {
        const double parts = static_cast<double>(links_.size() + 2);
        return [&context, i, name, parts](const ProgressUpdate& update) {
            if (!context.progress) return true;
            const std::string stage = name + (name.empty() ? "" : ": ") + std::string(update.stage);
            return context.progress({stage, (static_cast<double>(i) + update.fraction) / parts, -1});
        };
    }

    // One tree is read where it is; anything else becomes a tree in the scratch folder.
    void take_inputs(CloudSources& sources, bool selected, const Context& context, Result& result)
    {
        const bool is_tree_of_user =
            inputs_.size() == 1 && (is_tree(inputs_[0]) || is_tree_folder(tree_folder_of(inputs_[0])));
        result.values["points_skipped"] = 0;
        put_skipped(result, {});
        result.notes = sources.notes();
        if (is_tree_of_user && !selected) {
            tree_ = inputs_[0];
            result.outcome.points_in = Tree::open(tree_)->info().points;
            return;
        }
        auto cloud = sources.open();
        if (selected) cloud = require_points(std::move(cloud), [&sources] { return sources.bounds(); });
        BuildOptions build;
        build.memory_bytes = work_.memory;
        build.threads = work_.threads;
        build.progress = part(context, 0, "");
        const fs::path folder = next_folder();
        try {
            const BuildReport report = build_tree(*cloud, sources.names(), folder, build);
            result.outcome = report.outcome;
            result.values["points_skipped"] = report.points_skipped;
            put_skipped(result, report.skipped);
            result.notes.insert(result.notes.end(), report.notes.begin(), report.notes.end());
        } catch (const Error& error) {
            throw renamed(error, folder, place_);
        }
        result.outcome.points_in = result.outcome.points_out;
        tree_ = folder;
        is_scratch_ = true;
    }

    fs::path next_folder() { return scratch_->work() / (std::to_string(folders_++) + tree_extension); }

    // Whether the levels of a step's tree are those of the output: no later step makes new ones.
    bool keeps_levels(std::size_t i) const
    {
        return !is_file() && std::none_of(links_.begin() + static_cast<std::ptrdiff_t>(i) + 1, links_.end(),
                                          [](const Link& link) { return writes_new_cloud(*link.operation); });
    }

    // Where a step reads and writes. The last one writes the output, if it can.
    void connect(const Link& link, bool last)
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
            if (Argument* const over = arguments.find("overwrite"); over && to_place) over->set(overwrite_);
            return;
        }
        target_ = tree_;
        if (Argument* const in_place = arguments.find("in_place"); in_place && in_place->is_in(Face::command))
            in_place->set(true);
    }

    // A tree of the user's is not changed: a copy of it is, which shares its data where the file system allows.
    void copy_tree()
    {
        struct Copied {
            Outcome outcome;
        };
        const fs::path folder = next_folder();
        UpdateTarget(tree_, {folder, false, false}).update([](const fs::path&) { return Copied(); });
        tree_ = folder;
        is_scratch_ = true;
    }

    void run_link(std::size_t i, const Context& context, Result& result)
    {
        const Link& link = links_[i];
        Context own;
        own.progress = part(context, i + 1, link.row->name);
        own.keeps_levels = keeps_levels(i);
        own.gpu_radii = [](const GpuRadiiRequest&) -> Result {
            throw ArgumentError("device=gpu: a chain computes on the processor");
        };
        Result answer;
        try {
            connect(link, is_last(i));
            answer = link.operation->run(own);
        } catch (const Error& error) {
            throw in_step(error, link);
        } catch (const ArgumentError& error) {
            throw ArgumentError(link.name + ": " + error.what());
        }
        if (answer.makes == Makes::nothing)
            throw ArgumentError(link.name + ": this only counts, and a step of a chain writes something");
        if (is_scratch_ && target_ != tree_) {
            std::error_code ignored;
            fs::remove_all(tree_, ignored);  // at the latest the scratch folder goes
        }
        add_answer(link, answer, result);
        tree_ = target_;
        is_scratch_ = true;
    }

    Error in_step(const Error& error, const Link& link) const
    {
        const std::string inputs = inputs_.size() == 1 ? inputs_[0] : "the inputs";
        const auto shown = [&](std::string text) {
            text = renamed(std::move(text), tree_, inputs);
            return renamed(std::move(text), scratch_->work(), place_);
        };
        return Error(error.code(), shown(error.path().string()), link.name + ": " + shown(text_alone(error)),
                     error.hint());
    }

    void add_answer(const Link& link, const Result& answer, Result& result) const
    {
        const std::string name = link.row->name;
        Json json{{"operation", name}};
        const Json answered = json_of(name, answer);
        for (const char* const key : {"points", "seconds", "warnings", "notes", "points_in"}) json[key] = answered[key];
        for (const auto& [key, value] : answer.values.items()) json[key] = value;
        result.values["steps"].push_back(std::move(json));
        for (const std::string& note : answer.notes)
            if (std::find(result.notes.begin(), result.notes.end(), note) == result.notes.end())
                result.notes.push_back(name + ": " + note);
        for (const std::string& warning : answer.outcome.warnings)
            result.outcome.warnings.push_back(name + ": " + warning);
        for (const std::string& line : answer.lines) {
            std::string text = line;
            for (const std::string& start : {target_.string() + ": ", name + ": "})
                if (text.compare(0, start.size(), start) == 0) text.erase(0, start.size());
            result.line(name + ": " + text);
        }
        const bool is_tree = !written_ || !is_file();
        result.outcome.points_out = is_tree ? Tree::open(target_)->info().points : answer.outcome.points_out;
    }

    // A tree whose last step wrote no file.
    void write_file(const Context& context, Result& result)
    {
        ConvertOptions options;
        options.memory_bytes = work_.memory;
        options.threads = options.write.threads = work_.threads;
        options.overwrite = overwrite_;
        options.progress = part(context, links_.size() + 1, "");
        try {
            const ConvertReport report = pcm::convert({tree_}, place_, options);
            result.outcome.points_out = report.outcome.points_out;
            for (const std::string& warning : report.outcome.warnings) result.outcome.warnings.push_back(warning);
            result.notes.insert(result.notes.end(), report.notes.begin(), report.notes.end());
        } catch (const Error& error) {
            throw renamed(error, tree_, place_);
        }
    }

    std::vector<std::string> inputs_;
    std::string output_;
    bool overwrite_ = false;
    std::vector<Step> steps_;
    RegionArguments region_;
    ReadingArguments reading_;
    WorkArguments work_;
    // What is being done.
    std::vector<Link> links_;
    fs::path place_;                          // where the output goes
    std::unique_ptr<ScratchFolder> scratch_;  // next to it
    std::size_t folders_ = 0;                 // made in it
    fs::path tree_, target_;                  // what the next step reads; what it writes
    bool is_scratch_ = false;                 // the tree may be changed: it is not the user's
    bool written_ = false;                    // the output is
};

}  // namespace

Row run_row()
{
    return {
        "run",
        nullptr,
        "Run several operations on a cloud, one after the other, and write the last one's result",
        "Takes files, folders or trees through a chain of operations: points are denoised, thinned and given normals "
        "by one command, in bounded memory. What lies between the steps is in a folder next to the output, which "
        "goes when the command ends; the inputs are not changed. The output has its name only when all of it is "
        "written, as a tree or as a file of its extension's format. A step is an operation and its values: first "
        "those that its help lists, without names, then others as <i>NAME=VALUE</i>, and the names of flags, all "
        "separated by commas.",
        0,
        nullptr,
        with_skipped_keys(
            {{"steps", "list", "", "for each step: operation, points, seconds, warnings, notes, its own results"},
             {"points_skipped", "count", "points", "without a finite position, or beyond the largest coordinate"}}),
        make<Run>};
}

}  // namespace pcm::ops
