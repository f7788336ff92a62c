// Append to Point Cloud Tree: files are added to a tree.
#include "pcm/update/append.h"

#include "pcm/convert/open_cloud.h"
#include "pcm/system/error.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    add_inputs_parameter(parameters,
                         "all their points are added. The points must lie on the tree's grid, and the tree must have "
                         "all their attributes.");
    add_largest_coordinate_parameter(parameters);
    add_target_parameters(parameters);
    add_ignore_crs_parameter(parameters);
    add_work_parameters(parameters);
}

void run(const FilterRun& run)
{
    const std::filesystem::path tree = tree_of(run.parameters, run.document);
    AppendOptions options;
    options.memory_bytes = memory_of(run.parameters);
    options.threads = threads_of(run.parameters);
    CloudOptions reading;
    reading.read = reading_of(run.parameters);
    reading.read.ignore_crs = options.ignore_crs = ignore_crs_of(run.parameters);
    reading.read.largest_coordinate = largest_coordinate_of(run.parameters);
    CloudSources sources(inputs_of(run.parameters), reading);
    if (sources.has(tree_folder_of(tree)))
        throw Error(ErrorCode::invalid_argument, tree, "this tree is among the inputs: its points would be there twice",
                    "name other inputs");
    const std::unique_ptr<PointReader> cloud = sources.open();

    Operation operation(run.callback);
    options.progress = operation.progress();
    UpdateTarget target(tree, target_of(run.parameters));
    const AppendReport report = target.update(
        [&](const std::filesystem::path& folder) { return append_points(folder, *cloud, sources.names(), options); });
    log_warnings(run, report.outcome.warnings);
    run.log("Added " + grouped(report.points_added) + " points to " + target.path().string() + " in " +
            brief(report.outcome.seconds) + " s. The tree now has " + grouped(report.outcome.points_out) +
            " points in " + std::to_string(report.parts) + (report.parts == 1 ? " part." : " parts."));
    run.log("Largest position error: " + exact(report.outcome.error) + " source units.");
    log_skipped(run, report.points_skipped);
    log_notes(run, sources.notes());
    log_notes(run, report.notes);
    show_result(run, tree, target_of(run.parameters));
}

}  // namespace

Filter append()
{
    using F = MeshFilterInterface;
    return {"Append to Point Cloud Tree",
            "Adds the points of one or more files to a <b>point cloud tree</b>, either in place or in a copy that "
            "shares the data of the original. Existing points are not rewritten, so the time depends on the number of "
            "new points only. Every level of detail stays as even as before. Esc cancels it.",
            F::FilterClass(F::MeshCreation | F::PointSet),
            add_parameters,
            run,
            "-more.pct"};
}

}  // namespace pcm::host
