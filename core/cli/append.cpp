#include "pcm/update/append.h"

#include "pcm/cli/common.h"
#include "pcm/cli/reading.h"
#include "pcm/convert/open_cloud.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    ReadingOptions reading;
    std::string tree;
    std::vector<std::string> inputs;
    std::uint64_t memory = std::uint64_t(1) << 30;
    AppendOptions options;
};

int append(Arguments& arguments)
{
    CloudOptions cloud_options;
    cloud_options.read = arguments.reading.get(arguments.options.threads);
    CloudSources sources({arguments.inputs.begin(), arguments.inputs.end()}, cloud_options);
    if (sources.has(tree_folder_of(arguments.tree)))
        throw Error(ErrorCode::invalid_argument, arguments.tree,
                    "this tree is among the inputs: its points would be there twice", "name other inputs");
    const std::unique_ptr<PointReader> cloud = sources.open();
    arguments.options.memory_bytes = arguments.memory;
    arguments.options.ignore_crs = cloud_options.read.ignore_crs;
    arguments.options.progress = console_progress(arguments.common);
    AppendReport report = append_points(arguments.tree, *cloud, sources.names(), arguments.options);
    report.notes.insert(report.notes.begin(), sources.notes().begin(), sources.notes().end());
    end_progress(arguments.common);
    if (arguments.common.json) {
        Json json;
        json["tree"] = arguments.tree;
        put_outcome(json, report.outcome);
        json["points_added"] = report.points_added;
        json["points_skipped"] = report.points_skipped;
        put_skipped(json, report.skipped);
        json["nodes_added"] = report.nodes_added;
        json["bytes_written"] = report.bytes_written;
        json["parts"] = report.parts;
        json["position_error"] = report.outcome.error;
        json["notes"] = report.notes;
        print_json(json);
        return finished(report.outcome);
    }
    for (const std::string& note : report.notes) std::printf("note: %s\n", note.c_str());
    std::printf(
        "%s: %s points added in %.1f s (%.2f M points/s), %s nodes, %s; now %s points in %u parts\n",
        arguments.tree.c_str(), grouped(report.points_added).c_str(), report.outcome.seconds,
        report.outcome.seconds > 0 ? static_cast<double>(report.points_added) / report.outcome.seconds / 1e6 : 0.0,
        grouped(report.nodes_added).c_str(), bytes_text(report.bytes_written).c_str(),
        grouped(report.outcome.points_out).c_str(), report.parts);
    std::printf("largest position error %s source units, peak memory %s\n", exact(report.outcome.error).c_str(),
                bytes_text(peak_memory_bytes()).c_str());
    return finished(report.outcome);
}

}  // namespace

Run add_append(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    options.positional("input", arguments->inputs, "Files, folders with their sub-folders, or trees to add").required();
    options.option("-m,--memory", arguments->memory, "Memory limit, e.g. 512M or 2G (default 1G)").bytes();
    options.option("-t,--threads", arguments->options.threads, "Threads (default: one per processor)");
    options.option("--chunk-points", arguments->options.chunk_points,
                   "Maximum number of points per chunk (default 25000)");
    arguments->reading.add_to(options);
    arguments->reading.add_ignore_crs(options);
    add_common(options, arguments->common);
    return [arguments] { return append(*arguments); };
}

}  // namespace pcm::cli
