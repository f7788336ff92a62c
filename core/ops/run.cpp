// A chain of operations: files, folders or trees go in, one tree or file comes out.
#include "pcm/build/builder.h"
#include "pcm/ops/shared/chain.h"
#include "pcm/ops/shared/reading_arguments.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/shared/step.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace pcm::ops {
namespace {

constexpr std::uint64_t chain_memory = std::uint64_t(1) << 30;

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

    Result answer(const Context& context) override
    {
        std::vector<Link> steps = links();
        ChainOptions options;
        options.inputs = inputs_;
        options.output = output_;
        options.overwrite = overwrite_;
        options.reading.read = reading_.get(work_.threads);
        options.reading.selection = region_.get();
        options.memory_bytes = work_.memory;
        options.threads = work_.threads;
        Chain chain(std::move(options), steps);
        const std::vector<Result> answers = chain.run(context);
        Result result = chain.summary();
        std::vector<Accuracy> accuracies{*result.accuracy};
        for (const Result& step : answers) accuracies.push_back(*step.accuracy);
        result.accuracy = of_steps(accuracies);
        result.values["steps"] = Json::array();
        for (std::size_t i = 0; i < answers.size(); ++i)
            add_answer(steps[i].row->name, answers[i], chain.path(), result);
        result.print("%s: %s points of %s in %s steps", output_.c_str(), grouped(result.outcome.points_out).c_str(),
                     grouped(result.outcome.points_in).c_str(), grouped(steps.size()).c_str());
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

    // Everything that is wrong with the steps as they are written comes before any work.
    std::vector<Link> links()
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
            operations_.push_back(row.make());
            Link link{&row, operations_.back().get(),
                      "step " + std::to_string(i + 1) + ", " + row.name + " " + steps_[i].values};
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

    // Lines of a step begin with its name; notes and warnings, too.
    static void add_answer(const std::string& name, const Result& answer, const std::string& output, Result& result)
    {
        Json json{{"operation", name}};
        const Json answered = json_of(name, answer);
        for (const auto& [key, value] : answered.items())
            if (key != "command" && key != "version" && key != "input" && key != "output") json[key] = value;
        result.values["steps"].push_back(std::move(json));
        for (const std::string& note : answer.notes)
            if (std::find(result.notes.begin(), result.notes.end(), note) == result.notes.end())
                result.notes.push_back(name + ": " + note);
        for (const std::string& warning : answer.outcome.warnings)
            result.outcome.warnings.push_back(name + ": " + warning);
        for (const std::string& line : all_lines(answer)) {
            std::string text = line;
            for (const std::string& start : {output + ": ", name + ": "})
                if (text.compare(0, start.size(), start) == 0) text.erase(0, start.size());
            result.line(name + ": " + text);
        }
    }

    std::vector<std::string> inputs_;
    std::string output_;
    bool overwrite_ = false;
    std::vector<Step> steps_;
    RegionArguments region_;
    ReadingArguments reading_;
    WorkArguments work_;
    std::vector<std::unique_ptr<Operation>> operations_;  // one for each step
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
            {{"steps", "list", "", "for each step: operation, and its own answer"},
             {"points_skipped", "count", "points", "without a finite position, or beyond the largest coordinate"}}),
        make<Run>,
        {},
        "Limits of time and error are those of its steps."};
}

}  // namespace pcm::ops
