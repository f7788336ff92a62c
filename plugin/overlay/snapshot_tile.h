// MeshLab draws a snapshot of several times the view's resolution in tiles: each is a part of the view, magnified to
// the size of the view (MeshLab's glarea.cpp: setView, setTiledView). What belongs to the picture as a whole, such as
// labels, is placed in the whole snapshot, and each tile draws its part. No OpenGL here.
#pragma once

#include "pcm/view/camera.h"

#include <QPoint>

namespace pcm::host {

struct SnapshotTile {
    Camera whole;          // camera of the whole snapshot
    QPoint corner;         // the tile's lower left corner in it, pixels from its lower left corner
    double magnified = 1;  // width and height of the snapshot, in those of the view
    bool is_part() const { return magnified > 1; }
};

// What a camera of MeshLab's shows, with the view's `fov` (degrees; 5: orthographic). A camera of the view itself is
// the whole.
SnapshotTile tile_of(const Camera& camera, float fov);

}  // namespace pcm::host
