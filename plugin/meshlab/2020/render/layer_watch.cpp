#include "plugin/meshlab/2020/render/layer_watch.h"

#include "plugin/meshlab/2020/drawn_copy.h"

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

// Entries belong to their document: its destruction drops them, and so pending calls with it.
LayerWatch::Entry& LayerWatch::entry(const MeshModel& layer)
{
    MeshDocument* const document = layer.parent;
    const int mesh_id = layer.id();
    auto& slot = entries_[{document, mesh_id}];
    if (slot) return *slot;
    slot = std::make_unique<Entry>();
    const auto run = [this, document, mesh_id](QTimer& timer, void (LayerWatch::*action)(MeshModel&)) {
        timer.setSingleShot(true);
        connect(&timer, &QTimer::timeout, this, [this, document, mesh_id, action] {
            if (MeshModel* present = document->getMesh(mesh_id)) (this->*action)(*present);
        });
    };
    run(slot->rest, &LayerWatch::check);
    run(slot->changing, &LayerWatch::wait_for_rest);
    connect(document, &QObject::destroyed, this, [this, document] {
        for (auto it = entries_.begin(); it != entries_.end();)
            it = it->first.first == document ? entries_.erase(it) : std::next(it);
    });
    return *slot;
}

void LayerWatch::check(MeshModel& layer)
{
    if (layer.parent->isBusy()) {  // a filter is changing it; MeshLab restarts decorators afterwards
        entry(layer).rest.start(rest_ms);
        return;
    }
    if (!is_outdated(layer, false)) return;
    Entry& watched = entry(layer);
    watched.last = {};
    watched.changing.start(change_ms);
    Registry::instance().drop_copy(layer);
}

bool LayerWatch::may_draw(const MeshModel& layer)
{
    const auto tree = Registry::instance().drawn(layer);
    if (!tree) return false;
    if (!tree->is_copy()) return true;
    const bool outdated = is_outdated(layer, true);
    entry(layer).rest.start(outdated ? 0 : rest_ms);
    return !outdated;
}

void LayerWatch::wait_for_rest(MeshModel& layer)
{
    Entry& watched = entry(layer);
    const LayerState now = state_of(layer, Watched::vertices);
    if (layer.parent->isBusy() || QApplication::mouseButtons() != Qt::NoButton || now != watched.last) {
        watched.last = now;
        watched.changing.start(change_ms);
        return;
    }
    if (!Registry::instance().drawn(layer)) emit copy_wanted(layer.parent, layer.id());
}

}  // namespace pcm::host
