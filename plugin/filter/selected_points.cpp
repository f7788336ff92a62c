#include "plugin/filter/selected_points.h"

#include "pcm/system/error.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/scene/scene_state.h"

namespace pcm::host {

std::pair<MeshModel*, TreeLayer> layer_with_tree(MeshDocument& document)
{
    MeshModel* const layer = document.mm();
    auto shown = layer ? Registry::instance().find(*layer) : std::nullopt;
    if (!shown)
        throw Error(ErrorCode::invalid_argument, {}, "the current layer shows no point cloud tree",
                    "choose a layer that does, or open a tree first");
    return {layer, std::move(*shown)};
}

SelectedLayer selected_layer(MeshDocument& document)
{
    auto [layer, shown] = layer_with_tree(document);
    auto points = scene_of(document).part<SceneState>().selection(layer_of(*layer));
    if (!points || points->empty())
        throw Error(ErrorCode::invalid_argument, shown.cloud->tree()->folder(),
                    "no point of the current layer is selected",
                    "select points with the tool Select Points or the filter Select Points of Point Cloud Tree");
    return {*layer, std::move(shown), std::move(points)};
}

void add_set_change_parameters(RichParameterList& parameters)
{
    add_target_parameters(parameters);
    add_work_parameters(parameters);
}

SetChangeOptions set_change_options_of(const RichParameterList& parameters)
{
    SetChangeOptions options;
    options.target = target_of(parameters);
    options.memory_bytes = memory_of(parameters);
    options.threads = threads_of(parameters);
    return options;
}

QString about_selections()
{
    return " Works on the current layer's selected points, made by the tool <i>Select Points</i> or the filter "
           "<i>Select "
           "Points of Point Cloud Tree</i>. A selection lasts until the tree changes or the project is closed; in a "
           "script of meshlabserver, for the one run.";
}

}  // namespace pcm::host
