#include "plugin/filter/moved_results.h"

#include "plugin/filter/tree_target.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/scene/result_layer.h"

#include <utility>

namespace pcm::host {

OperationHooks shown_as_moved()
{
    OperationHooks hooks;
    hooks.after = [](const FilterRun& run, const ops::Operation&, const ops::Result& result) {
        if (result.output.empty()) return;  // a matrix was set
        SceneLayer* const former = layer_showing(scene_of(run.document), result.input.front());
        show_moved_result(run, result.output, former ? std::vector<SceneLayer*>{former} : std::vector<SceneLayer*>());
    };
    return hooks;
}

OperationHooks shown_as_merged()
{
    OperationHooks hooks;
    hooks.after = [](const FilterRun& run, const ops::Operation&, const ops::Result& result) {
        std::vector<SceneLayer*> merged;
        const char* const name = "VisibleLayers";
        if (!run.parameters.hasParameter(name) || run.parameters.getBool(name))
            for (SceneLayer* layer : scene_of(run.document).layers())
                if (layer->is_visible() && layer->tree()) merged.push_back(layer);
        show_moved_result(run, result.output, std::move(merged));
    };
    return hooks;
}

}  // namespace pcm::host
