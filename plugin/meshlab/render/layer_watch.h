// Looks at layers before they are drawn: a picture never shows vertices that a tool has changed or deleted.
//
// MeshLab restarts decorators after each filter and import; all vertices are looked at then. Edit tools change vertices
// without a word, so some of them are looked at in each paint event, and all of them when the view rests. GUI thread.
#pragma once

#include "plugin/meshlab/layer_state.h"
#include "plugin/scene/scene.h"

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>

#include <map>
#include <memory>
#include <utility>

namespace pcm::host {

class LayerWatch : public QObject {
    Q_OBJECT

public:
    // Never destroyed, as documents may be destroyed after any static object.
    static LayerWatch& instance();

    // Looks at all vertices. An outdated copy is dropped: views show MeshLab's own points until a new copy is made,
    // soon after the last change.
    void check(const SceneLayer& layer);

    // In a paint event: whether what views draw of the layer is up to date. If not, it is dropped after the event.
    bool may_draw(const SceneLayer& layer);

signals:
    // Asks to make a new copy: the layer is at rest and has none.
    void copy_wanted(pcm::host::Scene* scene, int layer_id);

private:
    struct Entry {
        QTimer rest;      // since the last paint event
        QTimer changing;  // since the last change
        LayerState last;
    };
    using Key = std::pair<Scene*, int>;

    LayerWatch() = default;
    Entry& entry(const SceneLayer& layer);
    void wait_for_rest(const SceneLayer& layer);

    std::map<Key, std::unique_ptr<Entry>> entries_;
};

}  // namespace pcm::host
