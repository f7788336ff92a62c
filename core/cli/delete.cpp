#include "pcm/cli/common.h"
#include "pcm/cli/region_options.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree.h"
#include "pcm/update/erase.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree;
    RegionOptions region;
    EraseOptions options;
};

int erase(Arguments& arguments)
{
    const Selection selection = arguments.region.get();
    if (!selection.chooses_points())
        throw Error(ErrorCode::invalid_argument, arguments.tree, "no points were chosen to be deleted",
                    "give a box, another region or a condition");
    const Box3d cloud = Tree::open(arguments.tree)->info().bounds();
    arguments.options.progress = console_progress(arguments.common);
    const EraseReport report = erase_points(arguments.tree, selection, arguments.options);
    end_progress(arguments.common);
    if (arguments.common.json) {
        Json json;
        json["tree"] = arguments.tree;
        put_outcome(json, report.outcome);
        json["points_deleted"] = report.points_deleted;
        json["done"] = !arguments.options.count_only;
        json["nodes_rewritten"] = report.nodes_rewritten;
        json["nodes_emptied"] = report.nodes_emptied;
        json["bytes_written"] = report.bytes_written;
        json["tree_bounds"] = cloud.empty() ? Json() : Json({{"min", cloud.min}, {"max", cloud.max}});
        json["levels_as_even_as_before"] = report.coverage_kept;
        print_json(json);
        return finished(report.outcome);
    }
    if (report.points_deleted == 0) std::printf("note: no point is selected; %s\n", extent_text(cloud).c_str());
    if (arguments.options.count_only) {
        std::printf("%s: %s of %s points would be deleted\n", arguments.tree.c_str(),
                    grouped(report.points_deleted).c_str(), grouped(report.outcome.points_in).c_str());
        return finished(report.outcome);
    }
    std::printf("%s: %s points deleted, %s left; %s nodes rewritten (%s), %s now empty, in %.1f s\n",
                arguments.tree.c_str(), grouped(report.points_deleted).c_str(),
                grouped(report.outcome.points_out).c_str(), grouped(report.nodes_rewritten).c_str(),
                bytes_text(report.bytes_written).c_str(), grouped(report.nodes_emptied).c_str(),
                report.outcome.seconds);
    if (!report.coverage_kept)
        std::printf(
            "note: coarse levels have gaps where points were deleted; 'pcmlab compact' closes them and frees the "
            "space\n");
    return finished(report.outcome);
}

}  // namespace

Run add_delete(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    arguments->region.add_to(options, "Points to delete");
    options.flag("--count", arguments->options.count_only, "Only report how many points would be deleted");
    options.option("-t,--threads", arguments->options.threads, "Threads (default: one per processor)");
    add_common(options, arguments->common);
    return [arguments] { return erase(*arguments); };
}

}  // namespace pcm::cli
