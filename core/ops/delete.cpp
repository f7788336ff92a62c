// Points of a tree are deleted.
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/shared/target_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/tree/tree.h"
#include "pcm/update/erase.h"

namespace pcm::ops {
namespace {

class Delete : public Operation {
public:
    Delete()
    {
        target_.declare_cloud(arguments_);
        region_.declare(arguments_, "Points to delete");
        arguments_.add("count", options_.count_only)
            .script("CountOnly")
            .label("Count only")
            .help("Only report how many points would be deleted; change nothing");
        target_.declare_copy(arguments_);
        work_.declare_threads(arguments_);
    }

    Result answer(const Context& context) override
    {
        const Selection selection = region_.get();
        if (!selection.chooses_points())
            throw Error(ErrorCode::invalid_argument, target_.tree, "no points were chosen to be deleted",
                        "give a box, another region or a condition");
        const Box3d cloud = Tree::open(target_.tree)->info().bounds();
        options_.threads = work_.threads;
        options_.progress = context.progress;
        Result result;
        EraseReport report;
        if (options_.count_only) {
            report = erase_points(target_.tree, selection, options_);
            result.input = {target_.tree};
        } else {
            UpdateTarget target(target_.tree, target_.choice(context.face, arguments_));
            report = target.update(
                [&](const std::filesystem::path& folder) { return erase_points(folder, selection, options_); });
            target_.describe(result, target.path().string());
        }
        describe(result, report, cloud);
        if (!options_.count_only && !report.coverage_kept && context.keeps_levels)
            result.notes.push_back(
                "coarse levels have gaps where points were deleted; the operation compact closes them and frees the "
                "space");
        return result;
    }

private:
    void describe(Result& result, const EraseReport& report, const Box3d& cloud) const
    {
        result.outcome = report.outcome;
        result.accuracy = exact_answer();
        result.values["points_deleted"] = report.points_deleted;
        result.values["done"] = !options_.count_only;
        result.values["nodes_rewritten"] = report.nodes_rewritten;
        result.values["nodes_emptied"] = report.nodes_emptied;
        result.values["bytes_written"] = report.bytes_written;
        result.values["tree_bounds"] = cloud.empty() ? Json() : Json({{"min", cloud.min}, {"max", cloud.max}});
        result.values["levels_as_even_as_before"] = report.coverage_kept;
        if (report.points_deleted == 0) result.notes.push_back("no point is selected; " + extent_text(cloud));
        if (options_.count_only) {
            result.line(target_.tree + ": " + grouped(report.points_deleted) + " of " +
                        points_text(report.outcome.points_in) + " would be deleted");
            return;
        }
        result.print("%s: %s points deleted, %s left; %s nodes rewritten (%s), %s now empty, in %.1f s",
                     result.output.c_str(), grouped(report.points_deleted).c_str(),
                     grouped(report.outcome.points_out).c_str(), grouped(report.nodes_rewritten).c_str(),
                     bytes_text(report.bytes_written).c_str(), grouped(report.nodes_emptied).c_str(),
                     report.outcome.seconds);
    }

    TargetArguments target_;
    RegionArguments region_;
    WorkArguments work_;
    EraseOptions options_;
};

}  // namespace

Row delete_row()
{
    return {"delete",
            "Delete Points of Point Cloud Tree",
            "Delete points of a tree",
            "Deletes the points of a <b>point cloud tree</b> that lie in a box or another region, or whose attributes "
            "meet conditions, either in place or in a copy that shares the data of the original. Only chunks that lose "
            "points are rewritten.",
            menu::points,
            "-without.pct",
            {{"points_deleted", "count", "points", "points deleted, or counted"},
             {"done", "flag", "", "false: they were only counted"},
             {"nodes_rewritten", "count", "", "chunks that lost points"},
             {"nodes_emptied", "count", "", "chunks without points now"},
             {"bytes_written", "count", "bytes", "size of what was rewritten"},
             {"tree_bounds", "object?", "source units", "min and max of the tree before; null: it had no points"},
             {"levels_as_even_as_before", "flag", "", "false: coarse levels have gaps"}},
            make<Delete>,
            {"where"},
            always_exact};
}

}  // namespace pcm::ops
