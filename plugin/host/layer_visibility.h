// Which layers of a document the views show, and layers that are shown alone. GUI thread.
#pragma once

#include <common/interfaces.h>

#include <QObject>

#include <map>
#include <set>

namespace pcm::host {

// Shows or hides a layer in all views of its document.
void show_layer(MeshModel& layer, bool on);

// Layers shown alone: while there are any, all others are hidden; when the last one is released, all are as they were
// before. One for each document.
class SoloLayers : public QObject {
    Q_OBJECT

public:
    static SoloLayers& of(MeshDocument& document);

    bool is_solo(const MeshModel& layer) const { return solo_.count(layer.id()) != 0; }
    void set(const MeshModel& layer, bool on);
    // Whether the layer is shown while no layer is shown alone.
    bool is_shown_otherwise(const MeshModel& layer) const;
    // As a project had it: these are shown alone, and of each layer whether it is shown otherwise.
    void restore(const std::set<int>& solo, const std::map<int, bool>& otherwise);

private:
    explicit SoloLayers(MeshDocument& document);
    void apply();

    MeshDocument& document_;
    std::set<int> solo_;
    std::map<int, bool> before_;  // what was visible
};

}  // namespace pcm::host
