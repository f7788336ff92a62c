#include "pcm/filter/merge.h"

#include "pcm/cli/common.h"
#include "pcm/system/peak_memory.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string output;
    std::vector<std::string> trees;
    std::uint64_t memory = std::uint64_t(1) << 30;
    MergeOptions options;
    ResultOptions result;
};

int merge(Arguments& arguments)
{
    arguments.result.target.copy = arguments.output;
    arguments.result.memory_bytes = arguments.memory;
    arguments.result.progress = console_progress(arguments.common);
    std::vector<MergeInput> inputs;
    for (const std::string& tree : arguments.trees) inputs.push_back({tree, {}});
    const MergeReport report = merge_trees(inputs, arguments.options, arguments.result);
    end_progress(arguments.common);
    const Outcome& outcome = report.build.outcome;
    if (arguments.common.json) {
        Json json;
        json["tree"] = arguments.output;
        put_outcome(json, outcome);
        json["points_in"] = outcome.points_in;
        json["trees"] = report.trees;
        json["grid"] = report.grid ? Json({{"scale", report.grid->scale}, {"offset", report.grid->offset}}) : Json();
        json["largest_rounding"] = report.rounding;
        json["crs"] = report.system.empty() ? Json() : Json(report.system);
        json["bytes"] = report.build.bytes;
        json["notes"] = report.build.notes;
        print_json(json);
        return finished(outcome);
    }
    for (const std::string& note : report.build.notes) std::printf("note: %s\n", note.c_str());
    std::printf("%s: %s points of %zu trees in %.1f s (%.2f M points/s), %s, peak memory %s\n",
                arguments.output.c_str(), grouped(outcome.points_out).c_str(), report.trees.size(), outcome.seconds,
                points_per_second(outcome) / 1e6, bytes_text(report.build.bytes).c_str(),
                bytes_text(peak_memory_bytes()).c_str());
    if (report.grid)
        std::printf("grid: steps %s, offset %s; coordinates changed by at most %s source units\n",
                    exact(report.grid->scale).c_str(), exact(report.grid->offset).c_str(),
                    exact(report.rounding).c_str());
    else
        std::printf("positions are doubles, changed by at most %s source units\n", exact(report.rounding).c_str());
    std::printf("coordinate system: %s\n", report.system.empty() ? "none stated" : report.system.c_str());
    return finished(outcome);
}

}  // namespace

Run add_merge(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("output", arguments->output, "The new tree's folder, by convention NAME.pct").required();
    options.positional("trees", arguments->trees, "Tree folders, or any file of each").required();
    options.flag("--source-id", arguments->options.source_id,
                 "Add an attribute source_id: the number of the tree that a point is from, from 1");
    options.flag("--ignore-crs", arguments->options.ignore_crs,
                 "Merge trees of different coordinate systems or GPS times; by default this is an error");
    options.flag("--overwrite", arguments->result.overwrite, "Replace an existing tree of the output's name");
    options.option("-m,--memory", arguments->memory, "Memory limit, e.g. 512M or 2G (default 1G)").bytes();
    options.option("-t,--threads", arguments->result.threads, "Threads (default: one per processor)");
    options.option("--chunk-points", arguments->result.chunk_points,
                   "Maximum number of points per chunk (default 25000)");
    add_common(options, arguments->common);
    return [arguments] { return merge(*arguments); };
}

}  // namespace pcm::cli
