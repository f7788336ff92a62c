// Layers that are shown alone. GUI thread.
#pragma once

#include "plugin/scene/scene.h"

#include <QObject>

#include <map>
#include <set>

namespace pcm::host {

// Layers shown alone: while there are any, all others are hidden; when the last one is released, all are as they were
// before. One for each scene.
class SoloLayers : public QObject {
    Q_OBJECT

public:
    explicit SoloLayers(Scene& scene);

    bool is_solo(const SceneLayer& layer) const { return solo_.count(layer.id()) != 0; }
    void set(const SceneLayer& layer, bool on);
    // Whether the layer is shown while no layer is shown alone.
    bool is_shown_otherwise(const SceneLayer& layer) const;
    // As a project had it: these are shown alone, and of each layer whether it is shown otherwise.
    void restore(const std::set<int>& solo, const std::map<int, bool>& otherwise);

private:
    void apply();

    Scene& scene_;
    std::set<int> solo_;
    std::map<int, bool> before_;  // what was visible
};

}  // namespace pcm::host
