// Compact Point Cloud Tree: the tree is rebuilt from its points.
#include "pcm/update/compact.h"

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
    add_work_parameters(parameters);
}

void run(const FilterRun& run)
{
    const std::filesystem::path tree = tree_of(run.parameters, run.document);
    CompactOptions options;
    options.memory_bytes = memory_of(run.parameters);
    options.threads = threads_of(run.parameters);
    Operation operation(run.callback);
    options.progress = operation.progress();
    const CompactReport report = compact_tree(tree, options);
    run.log("Compacted " + tree.string() + ": " + grouped(report.build.outcome.points_out) + " points, " +
            bytes_text(report.bytes_before) + " before, " + bytes_text(report.build.bytes) + " now, in " +
            brief(report.build.outcome.seconds) + " s.");
    log_warnings(run, report.build.outcome.warnings);
    show_afterwards(run, [&] { refresh_layers(run, tree); });
}

}  // namespace

Filter compact()
{
    using F = MeshFilterInterface;
    return {
        "Compact Point Cloud Tree",
        "Rebuilds a <b>point cloud tree</b> from its points: appended parts are merged, the space of deleted points "
        "is freed, and the levels of detail are even again. The old tree stays valid until the new one is "
        "complete. Esc cancels it.",
        F::FilterClass(F::MeshCreation | F::PointSet), add_parameters, run};
}

}  // namespace pcm::host
