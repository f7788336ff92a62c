#include "plugin/host/shown_points.h"

#include "pcm/cloud/selection.h"
#include "pcm/system/error.h"
#include "plugin/host/scene_state.h"
#include "plugin/host/view_camera.h"

#include <meshlab/glarea.h>

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
        } catch (const Error&) {  // views show all points then, and say so
        }
    }
    return kept;
}

Query shown_points(GLArea& view, const MeshModel& layer)
{
    Query query;
    const auto tree = Registry::instance().drawn(layer);
    const auto shown = shown_in(view);
    if (!tree || !shown) return query;
    if (const auto clip = clip_of(layer)) query.clips.push_back(*clip);
    query.where = applicable(shown->where, tree->cloud->info().schema);
    return query;
}

std::vector<MeshModel*> shown_layers(GLArea& view)
{
    std::vector<MeshModel*> layers;
    const auto shown = shown_in(view);
    if (!shown || !view.md()) return layers;
    for (const int mesh_id : shown->layers)
        if (MeshModel* layer = view.md()->getMesh(mesh_id); layer && Registry::instance().drawn(*layer))
            layers.push_back(layer);
    return layers;
}

}  // namespace pcm::host
