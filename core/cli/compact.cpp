#include "pcm/update/compact.h"

#include "pcm/cli/common.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree, output;
    std::uint64_t memory = std::uint64_t(1) << 30;
    CompactOptions options;
};

int compact(Arguments& arguments)
{
    arguments.options.output = arguments.output;
    arguments.options.memory_bytes = arguments.memory;
    arguments.options.progress = console_progress(arguments.common);
    const CompactReport report = compact_tree(arguments.tree, arguments.options);
    end_progress(arguments.common);
    const std::string& output = arguments.output.empty() ? arguments.tree : arguments.output;
    if (arguments.common.json) {
        Json json;
        json["tree"] = output;
        put_outcome(json, report.build.outcome);
        json["bytes_before"] = report.bytes_before;
        json["bytes"] = report.build.bytes;
        json["nodes"] = report.build.nodes;
        json["levels"] = report.build.levels;
        print_json(json);
        return finished(report.build.outcome);
    }
    std::printf("%s: %s points in %.1f s (%.2f M points/s), %llu nodes on %u levels, %s (%s before)\n", output.c_str(),
                grouped(report.build.outcome.points_out).c_str(), report.build.outcome.seconds,
                points_per_second(report.build.outcome) / 1e6, static_cast<unsigned long long>(report.build.nodes),
                report.build.levels, bytes_text(report.build.bytes).c_str(), bytes_text(report.bytes_before).c_str());
    return finished(report.build.outcome);
}

}  // namespace

Run add_compact(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    options.option("-o,--output", arguments->output, "Another tree folder to write (default: in place)");
    options.flag("--overwrite", arguments->options.overwrite, "Replace an existing tree of this name");
    options.option("-m,--memory", arguments->memory, "Memory limit, e.g. 512M or 2G (default 1G)").bytes();
    options.option("-t,--threads", arguments->options.threads, "Threads (default: one per processor)");
    options.option("--chunk-points", arguments->options.chunk_points,
                   "Maximum number of points per chunk (default 25000)");
    add_common(options, arguments->common);
    return [arguments] { return compact(*arguments); };
}

}  // namespace pcm::cli
