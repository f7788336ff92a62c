#include "plugin/scene/shown_points.h"

#include "pcm/cloud/selection.h"
#include "pcm/system/error.h"
#include "plugin/scene/scene_state.h"

namespace pcm::host {

std::vector<Condition> applicable(const std::vector<Condition>& where, const Schema& schema)
{
    std::vector<Condition> kept;
    for (const Condition& condition : where) {
        Selection one;
        one.where = {condition};
        try {
            Selector(one, schema);
            kept.push_back(condition);
        } catch (const Error&) {  // views then show all points, and report it
        }
    }
    return kept;
}

Query shown_points(SceneView& view, const SceneLayer& layer)
{
    Query query;
    const auto tree = layer.drawn();
    const auto& shown = view.shown();
    if (!tree || !shown) return query;
    if (const auto clip = clip_of(layer)) query.clips.push_back(*clip);
    query.where = applicable(shown->where, tree->cloud->info().schema);
    return query;
}

std::vector<SceneLayer*> shown_layers(SceneView& view)
{
    std::vector<SceneLayer*> layers;
    const auto& shown = view.shown();
    if (!shown) return layers;
    for (const int layer_id : shown->layers)
        if (SceneLayer* layer = view.scene().layer(layer_id); layer && layer->drawn()) layers.push_back(layer);
    return layers;
}

}  // namespace pcm::host
