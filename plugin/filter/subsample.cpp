// Subsample Point Cloud Tree: evenly, to a spacing or a number of points.
#include "pcm/filter/subsample.h"

#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/result_parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

#include <limits>

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    add_tree_parameter(parameters);
    parameters.addParam(RichEnum("By", 0, {"Spacing", "Number of points"}, "Thin to",
                                 "Whether 'Spacing', the default, or 'Number of points' counts."));
    parameters.addParam(RichFloat("Spacing", 0.1f, "Spacing",
                                  "Distance between neighbouring points, in source units: exactly, unless 'Exact' is "
                                  "off. Default 0.1."));
    parameters.addParam(RichInt("Points", 1000000, "Number of points",
                                "How many points the result has: exactly, unless 'Exact' is off. Default "
                                "1000000."));
    parameters.addParam(
        RichBool("Exact", true, "Exact",
                 "No two points are nearer than the spacing, and every point of the cloud has one that "
                 "is; or exactly the number of points. Off: quickly, the level of detail whose spacing is "
                 "nearest, which may be twice or half of the one given, or all points; or the finest "
                 "level with at most that many points. Default on."));
    add_result_parameters(parameters, true);
}

void run(const FilterRun& run)
{
    const std::filesystem::path tree = tree_of(run.parameters, run.document);
    ResultOptions result = result_options_of(run.parameters);
    SubsampleOptions options;
    options.exact = run.parameters.getBool("Exact");
    if (run.parameters.getEnum("By") == 1)
        options.points = static_cast<std::uint64_t>(
            in_range(run.parameters, "Points", "Number of points", 1, std::numeric_limits<int>::max()));
    else
        options.spacing = decimal_of(run.parameters, "Spacing");
    Operation operation(run.callback);
    result.progress = operation.progress();
    const SubsampleReport report = subsample(tree, options, result);
    std::string what = "Subsample of " + tree.string();
    if (report.level)
        what +=
            ", level " + std::to_string(report.level->level) + ", " +
            (report.level->spacing > 0 ? "spacing " + brief(report.level->spacing) + " source units" : "all points");
    else if (options.spacing)
        what += ", spacing exactly " + exact(*options.spacing) + " source units";
    log_result(run, what, report.build);
    if (!report.caveat.empty()) run.log("Note: " + report.caveat + ".");
    show_result(run, tree, result.target);
}

}  // namespace

Filter subsample_filter()
{
    using F = MeshFilterInterface;
    return {"Subsample Point Cloud Tree",
            "Makes a <b>point cloud tree</b> of an evenly spread part of another one's points, which keep all their "
            "attributes: exactly a spacing, exactly a number of points, or a level of detail, which is quick. It "
            "takes clouds of any size in bounded memory. Esc cancels it.",
            F::FilterClass(F::MeshCreation | F::PointSet | F::Sampling),
            add_parameters,
            run,
            "-thinned.pct"};
}

}  // namespace pcm::host
