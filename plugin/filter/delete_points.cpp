// Delete Points of Point Cloud Tree: those in a box, or that meet conditions.
#include "pcm/update/erase.h"

#include "pcm/system/error.h"
#include "pcm/tree/tree.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/selection_text.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    parameters.addParam(
        RichString("Box", "", "Box",
                   "Delete only points inside this box: its smallest x y z and its largest x y z, six numbers "
                   "separated by blanks, in source coordinates and units, bounds included. Empty, the default: no "
                   "box."));
    parameters.addParam(
        RichString("Where", "", "Where",
                   "Delete only points that meet these conditions on attributes, separated by semicolons. "
                   "Example: classification = 7,18; intensity < 10. Empty, the default: no condition."));
    parameters.addParam(RichBool("CountOnly", false, "Count only",
                                 "Only report how many points would be deleted; change nothing. Default off."));
    add_target_parameters(parameters);
}

void run(const FilterRun& run)
{
    const std::filesystem::path tree = tree_of(run.parameters, run.document);
    const Selection selection = parse_selection(run.parameters.getString("Box"), run.parameters.getString("Where"));
    if (!selection.chooses_points())
        throw Error(ErrorCode::invalid_argument, {}, "neither a box nor a condition says which points to delete",
                    "give a box, conditions or both");
    const Box3d cloud = Tree::open(tree)->info().bounds();
    EraseOptions options;
    options.count_only = run.parameters.getBool("CountOnly");
    Operation operation(run.callback);
    options.progress = operation.progress();
    if (options.count_only) {
        const EraseReport report = erase_points(tree, selection, options);
        if (report.points_deleted == 0) run.log("No point is selected; " + extent_text(cloud) + ".");
        run.log(grouped(report.points_deleted) + " of the " + grouped(report.outcome.points_in) + " points of " +
                tree.string() + " would be deleted.");
        return;
    }
    UpdateTarget target(tree, target_of(run.parameters));
    const EraseReport report =
        target.update([&](const std::filesystem::path& folder) { return erase_points(folder, selection, options); });
    log_warnings(run, report.outcome.warnings);
    run.log("Deleted " + grouped(report.points_deleted) + " of the " + grouped(report.outcome.points_in) +
            " points of " + target.path().string() + " in " + brief(report.outcome.seconds) + " s.");
    if (report.points_deleted == 0) run.log("No point is selected; " + extent_text(cloud) + ".");
    if (!report.coverage_kept)
        run.log(
            "Coarse levels have gaps where points were deleted. Compact Point Cloud Tree closes the gaps and frees "
            "the space.");
    show_result(run, tree, target_of(run.parameters));
}

}  // namespace

Filter delete_points()
{
    using F = MeshFilterInterface;
    return {"Delete Points of Point Cloud Tree",
            "Deletes the points of a <b>point cloud tree</b> that lie in a box, or whose attributes meet conditions, "
            "either in place or in a copy that shares the data of the original. Only chunks that lose points are "
            "rewritten. Esc cancels it.",
            F::FilterClass(F::MeshCreation | F::PointSet),
            add_parameters,
            run,
            "-without.pct"};
}

}  // namespace pcm::host
