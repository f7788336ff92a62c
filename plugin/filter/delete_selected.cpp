// Selected Points: Delete.
#include "pcm/filter/set_changes.h"

#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/selected_points.h"
#include "plugin/filter/tree_target.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

void run(const FilterRun& run)
{
    const SelectedLayer selected = selected_layer(run.document);
    SetChangeOptions options = set_change_options_of(run.parameters);
    Operation operation(run.callback);
    options.progress = operation.progress();
    const SetErasure erased = pcm::delete_points(*selected.points, options);
    log_warnings(run, erased.report.outcome.warnings);
    run.log("Deleted " + grouped(erased.report.points_deleted) + " of the " + grouped(erased.report.outcome.points_in) +
            " points of " + erased.tree.string() + " in " + brief(erased.report.outcome.seconds) + " s.");
    if (!erased.report.coverage_kept)
        run.log(
            "Coarse levels have gaps where points were deleted. Compact Point Cloud Tree closes the gaps and frees "
            "the space.");
    show_result(run, selected.shown.cloud->tree()->folder(), options.target);
}

}  // namespace

Filter delete_selected()
{
    using F = MeshFilterInterface;
    return {"Selected Points: Delete",
            "Deletes the selected points of a <b>point cloud tree</b>, from a copy of it or in place. Only chunks that "
            "lose points are rewritten. Esc cancels it." +
                about_selections(),
            F::FilterClass(F::Selection | F::PointSet),
            add_set_change_parameters,
            run,
            "-without.pct"};
}

}  // namespace pcm::host
