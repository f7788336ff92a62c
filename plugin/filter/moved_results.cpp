#include "plugin/filter/moved_results.h"

#include "plugin/filter/tree_target.h"
#include "plugin/host/registry.h"
#include "plugin/host/result_layer.h"

#include <utility>

namespace pcm::host {

OperationHooks shown_as_moved()
{
    OperationHooks hooks;
    hooks.after = [](const FilterRun& run, const ops::Operation&, const ops::Result& result) {
        if (result.output.empty()) return;  // a matrix was set
        MeshModel* const former = layer_showing(run.document, result.input.front());
        show_moved_result(run, result.output, former ? std::vector<MeshModel*>{former} : std::vector<MeshModel*>());
    };
    return hooks;
}

OperationHooks shown_as_merged()
{
    OperationHooks hooks;
    hooks.after = [](const FilterRun& run, const ops::Operation&, const ops::Result& result) {
        std::vector<MeshModel*> merged;
        const char* const name = "VisibleLayers";
        if (!run.parameters.hasParameter(name) || run.parameters.getBool(name))
            for (MeshModel* layer : run.document.meshList)
                if (layer->visible && Registry::instance().find(*layer)) merged.push_back(layer);
        show_moved_result(run, result.output, std::move(merged));
    };
    return hooks;
}

}  // namespace pcm::host
