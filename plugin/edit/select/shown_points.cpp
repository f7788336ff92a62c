#include "plugin/edit/select/shown_points.h"

#include "pcm/cloud/selection.h"
#include "pcm/system/error.h"
#include "plugin/host/scene_state.h"
#include "plugin/host/view_camera.h"

#include <meshlab/glarea.h>

namespace pcm::host {

namespace {

// Whether the cloud has what the condition is about.
bool applies(const Condition& condition, const Schema& schema)
{
    try {
        Selection one;
        one.where = {condition};
        const Selector test(one, schema);
        return true;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

Query shown_points(GLArea& view, const MeshModel& layer)
{
    Query query;
    const auto tree = Registry::instance().drawn(layer);
    const auto shown = shown_in(view);
    if (!tree || !shown) return query;
    if (const auto clip = clip_of(layer)) query.clips.push_back(*clip);
    for (const Condition& condition : shown->where)
        if (applies(condition, tree->cloud->info().schema)) query.where.push_back(condition);
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
