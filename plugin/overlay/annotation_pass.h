// Draws the annotations of a document (scene/annotations.h) over its clouds: lines and crosses, faint where points hide
// them, and labels.
#pragma once

#include "plugin/scene/scene.h"

#include "pcm/gl/draw/line_pass.h"
#include "pcm/view/camera.h"
#include "plugin/overlay/label_places.h"
#include "plugin/overlay/snapshot_tile.h"
#include "plugin/scene/annotations.h"

#include <QImage>
#include <QString>

#include <map>

namespace pcm::host {

// GL thread with the view's context, which is a compatibility one for labels.
class AnnotationPass {
public:
    // Into the current framebuffer; `camera` is in source coordinates of the document's scene (its origin is the
    // document's), and of the viewport's size. `ratio` pixels of the picture are one of Qt's. For a snapshot's tile,
    // `tile` gives the part of the picture that it is.
    void draw(Scene& scene, const Camera& camera, const SnapshotTile& tile, double ratio);
    void release() { lines_.release(); }

private:
    const QImage& image_of(const QString& text, double ratio);

    LinePass lines_;
    std::map<QString, QImage> images_;  // labels for `ratio_`
    double ratio_ = 1;
};

}  // namespace pcm::host
