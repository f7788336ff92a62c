#include "plugin/host/layer_visibility.h"

#include "plugin/host/registry.h"

#include <meshlab/glarea.h>

namespace pcm::host {

void show_layer(MeshModel& layer, bool on)
{
    layer.visible = on;
    for (GLArea* view : views_of(*layer.parent)) {
        view->meshVisibilityMap[layer.id()] = on;
        view->update();
    }
}

SoloLayers::SoloLayers(MeshDocument& document) : QObject(&document), document_(document)
{
    connect(&document, &MeshDocument::meshRemoved, this, [this](int mesh_id) {
        before_.erase(mesh_id);
        if (solo_.erase(mesh_id)) apply();
    });
}

SoloLayers& SoloLayers::of(MeshDocument& document)
{
    auto* found = document.findChild<SoloLayers*>(QString(), Qt::FindDirectChildrenOnly);
    return found ? *found : *new SoloLayers(document);
}

void SoloLayers::set(const MeshModel& layer, bool on)
{
    if (on == is_solo(layer)) return;
    if (solo_.empty())
        for (const MeshModel* each : document_.meshList)
            if (each) before_[each->id()] = each->visible;
    if (on)
        solo_.insert(layer.id());
    else
        solo_.erase(layer.id());
    apply();
}

bool SoloLayers::is_shown_otherwise(const MeshModel& layer) const
{
    const auto found = before_.find(layer.id());
    return found == before_.end() ? layer.visible : found->second;
}

void SoloLayers::restore(const std::set<int>& solo, const std::map<int, bool>& otherwise)
{
    solo_ = solo;
    before_ = otherwise;
    apply();
}

void SoloLayers::apply()
{
    for (MeshModel* layer : document_.meshList) {
        if (!layer) continue;
        if (!solo_.empty()) {
            show_layer(*layer, solo_.count(layer->id()) != 0);
        } else if (const auto found = before_.find(layer->id()); found != before_.end()) {
            show_layer(*layer, found->second);
        }
    }
    if (solo_.empty()) before_.clear();
}

}  // namespace pcm::host
