#include "plugin/scene/layer_visibility.h"

#include "plugin/scene/scene_view.h"

namespace pcm::host {

SoloLayers::SoloLayers(Scene& scene) : QObject(&scene), scene_(scene)
{
    connect(&scene, &Scene::layer_removed, this, [this](int layer_id) {
        before_.erase(layer_id);
        if (solo_.erase(layer_id)) apply();
    });
}

void SoloLayers::set(const SceneLayer& layer, bool on)
{
    if (on == is_solo(layer)) return;
    if (solo_.empty())
        for (const SceneLayer* each : scene_.layers()) before_[each->id()] = each->is_visible();
    if (on)
        solo_.insert(layer.id());
    else
        solo_.erase(layer.id());
    apply();
}

bool SoloLayers::is_shown_otherwise(const SceneLayer& layer) const
{
    const auto found = before_.find(layer.id());
    return found == before_.end() ? layer.is_visible() : found->second;
}

void SoloLayers::restore(const std::set<int>& solo, const std::map<int, bool>& otherwise)
{
    solo_ = solo;
    before_ = otherwise;
    apply();
}

void SoloLayers::apply()
{
    for (SceneLayer* layer : scene_.layers()) {
        if (!solo_.empty()) {
            layer->show(solo_.count(layer->id()) != 0);
        } else if (const auto found = before_.find(layer->id()); found != before_.end()) {
            layer->show(found->second);
        }
    }
    if (solo_.empty()) before_.clear();
}

}  // namespace pcm::host
