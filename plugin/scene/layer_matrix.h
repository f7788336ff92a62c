// The matrices of a document's layers: changed with undo and redo, and locked. GUI thread.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/cloud/geometry.h"
#include "plugin/scene/scene_view.h"

#include <QObject>
#include <QString>

#include <cstddef>
#include <filesystem>
#include <map>
#include <vector>

namespace pcm::host {

// The layer's matrix that moves the cloud's source coordinates by `map`, where MeshLab's coordinates are source
// coordinates minus `origin`. Rounded to single precision, as MeshLab stores it: see matrix_rounding().
LayerMatrix matrix_of(const Affine& map, const Vec3d& origin);

// The maximum distance that this rounding moves the points in `box` (source coordinates of the cloud), source units:
// the largest distance at the box's corners.
double matrix_rounding(const Affine& map, const Vec3d& origin, const Box3d& box);

// What the matrix does to source coordinates; of a layer with a sample, placement_of() counts a frozen matrix too.
Affine map_of(const LayerMatrix& matrix, const Vec3d& origin);

// The map `inner`, then `outer`.
Affine after(const Affine& outer, const Affine& inner);

// One for each scene.
class LayerMatrices : public QObject {
    Q_OBJECT

public:
    explicit LayerMatrices(Scene& scene);

    // Changes the matrix, and the views show it; the former one can be restored. `words` describe what was done: "align
    // by 4 pairs". Throws Error(invalid_argument) for a locked layer and for a matrix with numbers that are not finite.
    void set(SceneLayer& layer, const LayerMatrix& matrix, const QString& words);
    // The words of the step that undo() takes back, or redo() repeats; empty: there is none.
    QString undo_words(const SceneLayer& layer) const;
    QString redo_words(const SceneLayer& layer) const;
    // Throw as set() does.
    void undo(SceneLayer& layer);
    void redo(SceneLayer& layer);

    // The matrix of a locked layer is restored whatever changes it, and filters do not change its tree in place.
    bool is_locked(const SceneLayer& layer) const;
    void lock(SceneLayer& layer, bool on);
    // Called before the layer is drawn: puts the matrix of a locked layer back where something has changed it. True if
    // it did; the log reports it.
    bool hold(SceneLayer& layer);

signals:
    void changed(int layer_id);

private:
    struct Step {
        LayerMatrix before, after;
        QString words;
    };
    struct History {
        std::vector<Step> steps;
        std::size_t done = 0;  // steps that were not taken back
    };
    void put(SceneLayer& layer, const LayerMatrix& matrix);

    Scene& scene_;
    std::map<int, History> histories_;
    std::map<int, LayerMatrix> locked_;
};

// Throws Error(invalid_argument), naming the layer, if a locked layer of the document shows the tree. Called before a
// tree is changed in place.
void refuse_locked(Scene& scene, const std::filesystem::path& tree);

}  // namespace pcm::host
