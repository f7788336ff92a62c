// What a user has chosen in a document in addition to its layers: the clip box of the view, and the selected points of
// each tree. GUI thread.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/cloud/clip.h"
#include "pcm/query/point_set.h"
#include "plugin/scene/scene_view.h"

#include <QObject>
#include <QString>

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// A box of any direction, in the coordinates of the document's scene (annotations.h).
struct ClipBox {
    Vec3d centre{};
    std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};  // unit vectors, perpendicular
    Vec3d half{1, 1, 1};                                                        // half sizes, source units, above 0
    bool outside = false;  // what lies in the box is hidden; else all that does not
    bool enabled = true;

    // The clip for a cloud that `placement` (source coordinates to the scene's) moves; absent: it is where it is.
    // Throws Error(invalid_argument) for numbers that are not finite.
    Clip clip(const std::optional<Affine>& placement) const;
};

// The clip of the scene for one layer; nothing if there is none or it is switched off.
std::optional<Clip> clip_of(const SceneLayer& layer);

// One for each scene.
class SceneState : public QObject {
    Q_OBJECT

public:
    explicit SceneState(Scene& scene);

    const std::optional<ClipBox>& clip() const { return clip_; }
    void set_clip(std::optional<ClipBox> clip);

    // The selected points of the layer's tree; null: none, or the layer shows no tree, or another one than when they
    // were selected.
    std::shared_ptr<const PointSet> selection(const SceneLayer& layer) const;
    // Replaces the selection; the former one can be restored. `words` describe what was done: "polygon, 12,345 points".
    void select(const SceneLayer& layer, std::shared_ptr<const PointSet> points, const QString& words);
    // The words of the step that undo() takes back, or redo() repeats; empty: there is none.
    QString undo_words(const SceneLayer& layer) const;
    QString redo_words(const SceneLayer& layer) const;
    void undo(const SceneLayer& layer);
    void redo(const SceneLayer& layer);

signals:
    void clip_changed();
    void selection_changed(int layer_id);

private:
    struct Step {
        std::shared_ptr<const PointSet> points;  // after it
        QString words;
    };
    struct History {
        std::vector<Step> steps;
        std::size_t done = 0;  // steps that were not taken back
    };
    void changed(const SceneLayer& layer);

    Scene& scene_;
    std::optional<ClipBox> clip_;
    std::map<int, History> selections_;
};

}  // namespace pcm::host
