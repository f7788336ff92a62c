// Merge Point Cloud Trees: the trees of visible layers, at the places that the layers' matrices give them, and others.
#include "pcm/filter/merge.h"

#include "pcm/system/error.h"
#include "plugin/filter/filter.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/result_parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/placement.h"
#include "plugin/meshlab/2020/registry.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

#include <utility>

namespace pcm::host {

namespace {

void add_parameters(RichParameterList& parameters)
{
    parameters.addParam(
        RichBool("VisibleLayers", true, "Visible layers", "Merge the trees that the visible layers show. Default on."));
    parameters.addParam(RichBool("ApplyMatrices", true, "Apply matrices",
                                 "Each layer's tree is moved by the layer's matrix, as the view shows it. Off: all "
                                 "trees stay where their files say. Default on."));
    parameters.addParam(RichString("Trees", "", "Other trees",
                                   "Paths of further tree folders, NAME.pct, separated by semicolons. Empty, the "
                                   "default: none."));
    parameters.addParam(RichBool("SourceId", false, "Add source_id",
                                 "Add an attribute source_id: the number of the tree that a point is from, from 1. "
                                 "The log has the numbers. Default off."));
    add_ignore_crs_parameter(parameters);
    add_result_parameters(parameters, false);
}

// Those of visible layers, which are added to `merged`, and those that are named.
std::vector<MergeInput> inputs_of(const FilterRun& run, std::vector<SceneLayer*>& merged)
{
    std::vector<MergeInput> inputs;
    const bool apply = run.parameters.getBool("ApplyMatrices");
    if (run.parameters.getBool("VisibleLayers"))
        for (MeshModel* layer : run.document.meshList) {
            const auto tree = Registry::instance().find(*layer);
            if (!tree || !layer->visible) continue;
            const auto map = placement_of(*layer, *tree);
            inputs.push_back({tree->cloud->tree()->folder(), apply ? map : std::nullopt});
            merged.push_back(&layer_of(*layer));
            if (map)
                run.log("The layer '" + layer->label().toStdString() + "' has a matrix: it is " +
                        (apply ? "applied." : "not applied."));
        }
    for (const auto& path : split_paths(run.parameters.getString("Trees"))) inputs.push_back({path, {}});
    if (inputs.empty())
        throw Error(ErrorCode::invalid_argument, {}, "there are no trees to merge",
                    "show layers of trees, or name tree folders");
    return inputs;
}

void run(const FilterRun& run)
{
    ResultOptions result = result_options_of(run.parameters);
    MergeOptions options;
    options.ignore_crs = ignore_crs_of(run.parameters);
    options.source_id = run.parameters.getBool("SourceId");
    std::vector<SceneLayer*> merged;
    const std::vector<MergeInput> inputs = inputs_of(run, merged);
    Operation operation(run.callback);
    result.progress = operation.progress();
    const MergeReport report = merge_trees(inputs, options, result);
    log_result(run, "Merge of " + std::to_string(report.trees.size()) + " trees", report.build);
    run.log(report.grid ? "Grid: steps " + exact(report.grid->scale) + ", offset " + exact(report.grid->offset) +
                              "; coordinates changed by at most " + exact(report.rounding) + " source units."
                        : "Positions are doubles, changed by at most " + exact(report.rounding) + " source units.");
    run.log("Coordinate system: " + (report.system.empty() ? "none stated" : report.system) + ".");
    show_moved_result(run, result.target.copy, std::move(merged));
}

}  // namespace

Filter merge()
{
    using F = MeshFilterInterface;
    return {"Merge Point Cloud Trees",
            "Makes one <b>point cloud tree</b> of several: of the trees that visible layers show, where the layers' "
            "matrices put them, and of others on disk. Grids, attributes and coordinate systems are brought together; "
            "the log says how. The trees stay as they are. Esc cancels it.",
            F::FilterClass(F::MeshCreation | F::PointSet | F::Layer),
            add_parameters,
            run,
            "-merged.pct"};
}

}  // namespace pcm::host
