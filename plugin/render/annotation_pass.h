// Draws the annotations of a document (host/annotations.h) over its clouds: lines and crosses, faint where points hide
// them, and labels.
#pragma once

#include "pcm/gl/line_pass.h"
#include "pcm/view/camera.h"
#include "plugin/host/annotations.h"

#include <QImage>
#include <QRect>
#include <QSize>

#include <map>
#include <vector>

namespace pcm::host {

// A label, and where it stands: pixels of the screen from the view's lower left corner.
struct PlacedLabel {
    QString text;
    QRect place;  // its y is that of the lower edge
};

// Places for labels beside their anchors (window coordinates), in order: each on the first side where it covers no
// earlier one, moved into the view. An anchor outside of the view has no label.
std::vector<PlacedLabel> place_labels(const std::vector<std::pair<QString, QPointF>>& anchors,
                                      const std::map<QString, QSize>& sizes, const QSize& view);

// The text in white on a dark box, for a screen with `ratio` pixels to one of Qt's.
QImage label_image(const QString& text, double ratio);

// GL thread with the view's context, which is a compatibility one for labels.
class AnnotationPass {
public:
    // Into the current framebuffer; `camera` is in source coordinates of the document's scene (its origin is the
    // document's), and of the viewport's size. `ratio` pixels of the screen are one of Qt's. `magnified`: a tile of a
    // snapshot shows the view so many times larger; lines are as many times as wide, and there are no labels.
    void draw(const MeshDocument& document, const Camera& camera, double ratio, double magnified);
    void release() { lines_.release(); }

private:
    const QImage& image_of(const QString& text, double ratio);

    LinePass lines_;
    std::map<QString, QImage> images_;  // of labels, for `ratio_`
    double ratio_ = 1;
};

}  // namespace pcm::host
