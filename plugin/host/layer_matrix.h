// The matrices of a document's layers: changed with undo and redo, and locked. GUI thread.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/cloud/geometry.h"
#include "plugin/host/registry.h"

#include <common/interfaces.h>

#include <QObject>
#include <QString>

#include <cstddef>
#include <filesystem>
#include <map>
#include <vector>

namespace pcm::host {

// The layer's matrix that moves the cloud's source coordinates by `map`, where MeshLab's coordinates are source
// coordinates minus `origin`. Rounded to single precision, as MeshLab stores it: see matrix_rounding().
Matrix44m matrix_of(const Affine& map, const Vec3d& origin);

// By how much that rounding moves the points in `box` (source coordinates of the cloud) at most, source units: the
// largest distance at the box's corners.
double matrix_rounding(const Affine& map, const Vec3d& origin, const Box3d& box);

// What the matrix does to source coordinates; of a layer with a sample, placement_of() counts a frozen matrix too.
Affine map_of(const Matrix44m& matrix, const Vec3d& origin);

// The map `inner`, then `outer`.
Affine after(const Affine& outer, const Affine& inner);

// One for each document.
class LayerMatrices : public QObject {
    Q_OBJECT

public:
    static LayerMatrices& of(MeshDocument& document);

    // Changes the matrix, and the views show it; the former one can be had back. `words` say what was done: "align by 4
    // pairs". Throws Error(invalid_argument) for a locked layer and for a matrix with numbers that are not finite.
    void set(MeshModel& layer, const Matrix44m& matrix, const QString& words);
    // The words of the step that undo() takes back, or redo() repeats; empty: there is none.
    QString undo_words(const MeshModel& layer) const;
    QString redo_words(const MeshModel& layer) const;
    // Throw as set() does.
    void undo(MeshModel& layer);
    void redo(MeshModel& layer);

    // The matrix of a locked layer stays what it is, whatever changes it, and filters do not change its tree in place.
    bool is_locked(const MeshModel& layer) const;
    void lock(MeshModel& layer, bool on);
    // Called before the layer is drawn: puts the matrix of a locked layer back where something has changed it. True if
    // it did; the log says so.
    bool hold(MeshModel& layer);

signals:
    void changed(int mesh_id);

private:
    struct Step {
        Matrix44m before, after;
        QString words;
    };
    struct History {
        std::vector<Step> steps;
        std::size_t done = 0;  // steps that were not taken back
    };
    explicit LayerMatrices(MeshDocument& document);
    void put(MeshModel& layer, const Matrix44m& matrix);

    MeshDocument& document_;
    std::map<int, History> histories_;
    std::map<int, Matrix44m> locked_;
};

// Throws Error(invalid_argument), naming the layer, if a locked layer of the document shows the tree. Called before a
// tree is changed in place.
void refuse_locked(MeshDocument& document, const std::filesystem::path& tree);

}  // namespace pcm::host
