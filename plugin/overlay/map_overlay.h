// Draws the scale bar, the arrow to north and the grid of coordinates (map_marks.h) over a view.
#pragma once

#include "pcm/gl/draw/line_pass.h"
#include "pcm/view/camera.h"
#include "plugin/overlay/snapshot_tile.h"

#include <string>

namespace pcm::host {

// What a map has in addition to its content.
struct MapSettings {
    bool scale_bar = true, north = false, grid = false;
};

// The depth of the trackball's centre in MeshLab's views, eye units; for its `fov`.
double distance_to_pivot(float fov);

// GL thread with the view's context, a compatibility one.
class MapOverlay {
public:
    // Into the current framebuffer; `camera` is in source coordinates and of the viewport's size. `ratio` pixels of the
    // picture are one of Qt's. `above_text`: MeshLab writes its own text at the bottom of the view. For a snapshot's
    // tile, `tile` gives the part of the picture that it is.
    void draw(const Camera& camera, const SnapshotTile& tile, double depth, const std::string& unit,
              const MapSettings& settings, double ratio, bool above_text);
    void release() { lines_.release(); }

private:
    LinePass lines_;
};

}  // namespace pcm::host
