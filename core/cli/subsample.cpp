#include "pcm/filter/subsample.h"

#include "pcm/cli/common.h"
#include "pcm/cli/reading.h"
#include "pcm/cli/result_options.h"
#include "pcm/system/peak_memory.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    ReadingOptions reading;
    std::vector<std::string> inputs;
    ResultArguments result;
    SubsampleOptions options;
};

std::string chosen_text(const Arguments& arguments, const SubsampleReport& report)
{
    if (!report.level) {
        if (arguments.options.spacing) return "spacing " + exact(*arguments.options.spacing) + ", exactly";
        return "a level, and a part of the next";
    }
    return "level " + std::to_string(report.level->level) + ", " +
           (report.level->spacing > 0 ? "spacing " + brief(report.level->spacing) : "all points");
}

int run(Arguments& arguments)
{
    arguments.result.check();
    if (arguments.options.spacing.has_value() == arguments.options.points.has_value())
        throw UsageError("what to thin to: give either --spacing or --points");
    const ProgressFunction progress = console_progress(arguments.common);
    const Sources sources(arguments.inputs, arguments.result, arguments.reading, Sampling::poisson, progress);
    const SubsampleReport report = subsample(sources.path(), arguments.options, sources.result_options());
    end_progress(arguments.common);
    const Outcome& outcome = report.build.outcome;
    std::vector<std::string> notes = sources.notes(report.build.notes);
    if (!report.caveat.empty()) notes.push_back(report.caveat);
    if (arguments.common.json) {
        Json json;
        json["tree"] = sources.output().string();
        put_outcome(json, outcome);
        json["seconds"] = sources.seconds();
        json["points_in"] = outcome.points_in;
        json["exact"] = arguments.options.exact;
        if (report.level) {
            json["level"] = report.level->level;
            json["spacing"] = report.level->spacing;
        } else if (arguments.options.spacing) {
            json["spacing"] = *arguments.options.spacing;
        }
        json["bytes"] = report.build.bytes;
        json["notes"] = notes;
        std::printf("%s\n", json.dump(2).c_str());
        return finished(outcome);
    }
    for (const std::string& note : notes) std::printf("note: %s\n", note.c_str());
    std::printf("%s: %s points of %s (%s) in %.1f s, %s, peak memory %s\n", sources.output().c_str(),
                grouped(outcome.points_out).c_str(), grouped(outcome.points_in).c_str(),
                chosen_text(arguments, report).c_str(), sources.seconds(), bytes_text(report.build.bytes).c_str(),
                bytes_text(peak_memory_bytes()).c_str());
    return finished(outcome);
}

}  // namespace

Run add_subsample(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options
        .positional("input", arguments->inputs, "A tree, or files, folders and trees, which are merged into one cloud")
        .required();
    const Option spacing = options.option(
        "-s,--spacing", arguments->options.spacing,
        "Spacing of the points, source units, such as 0.5: the level whose spacing is nearest, unless --exact");
    options
        .option("-n,--points", arguments->options.points,
                "Number of points: the finest level with at most so many, unless --exact")
        .excludes(spacing);
    options.flag(
        "--exact", arguments->options.exact,
        "Exactly the spacing (no two points nearer, every point of the cloud near one), or exactly the number");
    arguments->result.add_to(options);
    arguments->reading.add_to(options);
    arguments->reading.add_ignore_crs(options);
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
