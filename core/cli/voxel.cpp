#include "pcm/filter/voxel_grid.h"

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
    double size = 0;
    std::vector<double> anchor;
    bool nearest = false;
    VoxelGridOptions options;
};

int voxel(Arguments& arguments)
{
    VoxelGridOptions& options = arguments.options;
    options.voxels.size = arguments.size;
    if (!arguments.anchor.empty())
        options.voxels.anchor = {arguments.anchor[0], arguments.anchor[1], arguments.anchor[2]};
    if (arguments.nearest) options.point = VoxelPoint::nearest;
    check_voxels(options.voxels, {}, nullptr);  // before files are read
    arguments.result.check();
    const ProgressFunction progress = console_progress(arguments.common);
    const Sources sources(arguments.inputs, arguments.result, arguments.reading, Sampling::grid, progress);
    const VoxelGridReport report = sources.apply(
        [&](const std::filesystem::path& tree, const ResultOptions& to) { return voxel_grid(tree, options, to); });
    end_progress(arguments.common);
    const Outcome& outcome = report.build.outcome;
    if (arguments.common.json) {
        Json json;
        json["tree"] = sources.output().string();
        put_outcome(json, outcome);
        json["seconds"] = sources.seconds();
        json["points_in"] = outcome.points_in;
        json["voxel_size"] = arguments.size;
        json["most_points_in_a_voxel"] = report.most_in_one;
        json["bytes"] = report.build.bytes;
        json["notes"] = sources.notes(report.build.notes);
        print_json(json);
        return finished(outcome);
    }
    for (const std::string& note : sources.notes(report.build.notes)) std::printf("note: %s\n", note.c_str());
    std::printf("%s: %s points of %s, one for each voxel of %s with points, in %.1f s (%.2f M points/s)\n",
                sources.output().c_str(), grouped(outcome.points_out).c_str(), grouped(outcome.points_in).c_str(),
                exact(arguments.size).c_str(), sources.seconds(),
                static_cast<double>(outcome.points_in) / std::max(1e-9, sources.seconds()) / 1e6);
    std::printf("at most %s points in a voxel, %s, peak memory %s\n", grouped(report.most_in_one).c_str(),
                bytes_text(report.build.bytes).c_str(), bytes_text(peak_memory_bytes()).c_str());
    return finished(outcome);
}

}  // namespace

Run add_voxel(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options
        .positional("input", arguments->inputs, "A tree, or files, folders and trees, which are merged into one cloud")
        .required();
    options.option("-s,--size", arguments->size, "Edge of a voxel, source units: --size 0.25").required();
    options.option("--anchor", arguments->anchor, "Voxels begin at x y z plus multiples of their size (default 0 0 0)")
        .values(3);
    options.flag("--nearest", arguments->nearest,
                 "Keep the point nearest to the centroid, unchanged, instead of the centroid and mean attributes");
    options.flag("--count", arguments->options.count,
                 "Add an attribute point_count: the number of points in the voxel");
    options
        .option("--majority", arguments->options.by_majority,
                "Attributes of which the most frequent value is taken, separated by commas (default: classification, "
                "return numbers, flags, identities)")
        .separated_by(',')
        .one_value_each();
    options
        .option("--mean", arguments->options.by_mean,
                "Attributes of which the mean is taken, separated by commas (default: all others)")
        .separated_by(',')
        .one_value_each();
    arguments->result.add_to(options);
    arguments->reading.add_to(options);
    arguments->reading.add_ignore_crs(options);
    add_common(options, arguments->common);
    return [arguments] { return voxel(*arguments); };
}

}  // namespace pcm::cli
