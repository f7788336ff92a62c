#include "plugin/meshlab/render/layer_watch.h"

#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/drawn_copy.h"
#include "plugin/meshlab/registry.h"

#include <QApplication>

namespace pcm::host {

namespace {

constexpr int rest_ms = 300;    // after the last paint event all vertices are looked at
constexpr int change_ms = 400;  // without a change before a new copy is made

}  // namespace

LayerWatch& LayerWatch::instance()
{
    static LayerWatch* const watch = new LayerWatch;
    return *watch;
}

// Entries belong to their scene: its destruction drops them, and so pending calls with it.
LayerWatch::Entry& LayerWatch::entry(const SceneLayer& layer)
{
    Scene* const scene = &layer.scene();
    const int layer_id = layer.id();
    auto& slot = entries_[{scene, layer_id}];
    if (slot) return *slot;
    slot = std::make_unique<Entry>();
    const auto run = [this, scene, layer_id](QTimer& timer, void (LayerWatch::*action)(const SceneLayer&)) {
        timer.setSingleShot(true);
        connect(&timer, &QTimer::timeout, this, [this, scene, layer_id, action] {
            if (const SceneLayer* const present = scene->layer(layer_id)) (this->*action)(*present);
        });
    };
    run(slot->rest, &LayerWatch::check);
    run(slot->changing, &LayerWatch::wait_for_rest);
    connect(scene, &QObject::destroyed, this, [this, scene] {
        for (auto it = entries_.begin(); it != entries_.end();)
            it = it->first.first == scene ? entries_.erase(it) : std::next(it);
    });
    return *slot;
}

void LayerWatch::check(const SceneLayer& layer)
{
    if (layer.scene().is_busy()) {  // a filter is changing it; MeshLab restarts decorators afterwards
        entry(layer).rest.start(rest_ms);
        return;
    }
    MeshModel& model = model_of(layer);
    if (!is_outdated(model, false)) return;
    Entry& watched = entry(layer);
    watched.last = {};
    watched.changing.start(change_ms);
    Registry::instance().drop_copy(model);
}

bool LayerWatch::may_draw(const SceneLayer& layer)
{
    const auto cloud = layer.drawn();
    if (!cloud) return false;
    if (!cloud->is_copy()) return true;
    const bool outdated = is_outdated(model_of(layer), true);
    entry(layer).rest.start(outdated ? 0 : rest_ms);
    return !outdated;
}

void LayerWatch::wait_for_rest(const SceneLayer& layer)
{
    Entry& watched = entry(layer);
    const LayerState now = state_of(model_of(layer), Watched::vertices);
    if (layer.scene().is_busy() || QApplication::mouseButtons() != Qt::NoButton || now != watched.last) {
        watched.last = now;
        watched.changing.start(change_ms);
        return;
    }
    if (!layer.drawn()) emit copy_wanted(&layer.scene(), layer.id());
}

}  // namespace pcm::host
