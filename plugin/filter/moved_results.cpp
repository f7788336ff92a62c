#include "plugin/filter/moved_results.h"

#include "plugin/scene/result_layer.h"

#include <utility>

namespace pcm::host {

namespace {

// The result takes the place of these layers, and has their matrices applied.
void show_moved(const FilterRun& run, const ops::Result& result, std::vector<SceneLayer*> replaced)
{
    show_afterwards(run, [&] { return show_result(run.scene, TreeResult{result.output, std::move(replaced), false}); });
}

}  // namespace

OperationHooks shown_as_moved()
{
    OperationHooks hooks;
    hooks.after = [](const FilterRun& run, const ops::Operation&, const ops::Result& result) {
        if (result.output.empty()) return;  // a matrix was set
        SceneLayer* const former = layer_showing(run.scene, result.input.front());
        show_moved(run, result, former ? std::vector<SceneLayer*>{former} : std::vector<SceneLayer*>());
    };
    return hooks;
}

OperationHooks shown_as_merged()
{
    OperationHooks hooks;
    hooks.after = [](const FilterRun& run, const ops::Operation&, const ops::Result& result) {
        std::vector<SceneLayer*> merged;
        const char* const name = "VisibleLayers";
        if (!run.parameters.has(name) || run.parameters.flag(name))
            for (SceneLayer* layer : run.scene.layers())
                if (layer->is_visible() && layer->tree()) merged.push_back(layer);
        show_moved(run, result, std::move(merged));
    };
    return hooks;
}

}  // namespace pcm::host
