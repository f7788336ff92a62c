// Remove Outliers of Point Cloud Tree: points that stand apart from the others are removed or labelled.
#include "pcm/filter/outliers.h"

#include "pcm/system/error.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/neighbour_parameters.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    parameters.addParam(RichEnum(
        "Method", 0, {"Statistical", "Robust", "By radius"}, "Method",
        "Which points are outliers. Statistical: their mean distance to their nearest neighbours is above mean + "
        "factor "
        "x deviation of all points. Robust: above median + factor x 1.4826 x MAD, also where outliers are very far or "
        "very many. By radius: they have fewer neighbours than given within the radius. Default statistical."));
    add_neighbours_parameter(parameters, 16, "that are looked at");
    parameters.addParam(
        RichFloat("Factor", 3, "Factor",
                  "Factor of the deviation, for the first two methods; the larger, the fewer points are "
                  "outliers. Default 3."));
    parameters.addParam(RichFloat("Radius", 0, "Radius",
                                  "Radius within which neighbours are counted by the third method, in the cloud's own "
                                  "units. Default 0: to be given for that method."));
    parameters.addParam(RichBool("Label", false, "Only label",
                                 "Remove no point: write the attribute outlier, 1 for outliers and 0 for others. "
                                 "Default off."));
    parameters.addParam(RichBool("Overwrite", false, "Overwrite",
                                 "Also write labels where the tree has an attribute outlier that this filter did not "
                                 "make, whose values are lost. Default off: refused."));
    parameters.addParam(RichBool("CountOnly", false, "Count only",
                                 "Only report how many points would be removed; change nothing. Default off."));
    add_target_parameters(parameters);
    add_work_parameters(parameters);
}

OutlierOptions options_of(const RichParameterList& parameters)
{
    OutlierOptions options;
    const int method = parameters.getEnum("Method");
    if (method < 0 || method > 2)
        throw Error(ErrorCode::invalid_argument, {}, "Method is " + std::to_string(method) + "; it must be 0 to 2");
    options.method = static_cast<OutlierMethod>(method);
    options.neighbours = neighbours_of(parameters);
    options.factor = static_cast<double>(parameters.getFloat("Factor"));
    options.radius = static_cast<double>(parameters.getFloat("Radius"));
    options.overwrite = parameters.getBool("Overwrite");
    options.label = parameters.getBool("Label");
    options.count_only = parameters.getBool("CountOnly");
    options.memory_bytes = memory_of(parameters);
    options.threads = threads_of(parameters);
    return options;
}

void log(const FilterRun& run, const OutlierOptions& options, const OutlierReport& report,
         const std::filesystem::path& tree)
{
    log_warnings(run, report.outcome.warnings);
    log_notes(run, report.notes);
    const char* done = options.count_only ? " would be removed" : options.label ? " were labelled" : " were removed";
    run.log(grouped(report.outliers) + " of the " + grouped(report.outcome.points_in) + " points of " + tree.string() +
            done + " in " + brief(report.outcome.seconds) + " s, peak memory " + bytes_text(report.peak_memory_bytes) +
            ".");
    if (options.method != OutlierMethod::radius)
        run.log("Mean distance to " + std::to_string(options.neighbours) + " neighbours: " +
                (options.method == OutlierMethod::robust ? "median " : "mean ") + brief(report.centre) +
                ", deviation " + brief(report.deviation) + "; outliers are above " + brief(report.threshold) + ".");
    if (!report.coverage_kept)
        run.log(
            "Coarse levels have gaps where points were removed. Compact Point Cloud Tree closes the gaps and frees "
            "the space.");
}

void run(const FilterRun& run)
{
    const std::filesystem::path tree = tree_of(run.parameters, run.document);
    OutlierOptions options = options_of(run.parameters);
    Operation operation(run.callback);
    options.progress = operation.progress();
    if (options.count_only) {
        log(run, options, pcm::remove_outliers(tree, options), tree);
        return;
    }
    UpdateTarget target(tree, target_of(run.parameters));
    const OutlierReport report =
        target.update([&](const std::filesystem::path& folder) { return pcm::remove_outliers(folder, options); });
    log(run, options, report, target.path());
    show_result(run, tree, target_of(run.parameters));
}

}  // namespace

Filter remove_outliers()
{
    using F = MeshFilterInterface;
    return {"Remove Outliers of Point Cloud Tree",
            "Removes the points of a <b>point cloud tree</b> that stand apart from the others, or labels them with the "
            "attribute <i>outlier</i>, in a copy of the tree or in place. All distances and statistics are computed in "
            "double precision. Works on clouds larger than memory. Esc cancels it.",
            F::FilterClass(F::MeshCreation | F::PointSet),
            add_parameters,
            run,
            "-clean.pct"};
}

}  // namespace pcm::host
