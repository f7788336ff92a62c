// Labels over a view: where they stand and how they look. No OpenGL here.
#pragma once

#include <QImage>
#include <QPointF>
#include <QRect>
#include <QSize>
#include <QString>

#include <map>
#include <utility>
#include <vector>

namespace pcm::host {

// A label, and where it stands: pixels of the screen from the view's lower left corner.
struct PlacedLabel {
    QString text;
    QRect place;  // its y is that of the lower edge
};

// Places for labels next to their anchors (window coordinates), in order: each on the first side where it covers no
// earlier one, or up to five rows farther above or below, moved into the view. An anchor outside of the view has no
// label.
std::vector<PlacedLabel> place_labels(const std::vector<std::pair<QString, QPointF>>& anchors,
                                      const std::map<QString, QSize>& sizes, const QSize& view);

// The text in white on a dark box, for a screen with `ratio` pixels to one of Qt's.
QImage label_image(const QString& text, double ratio);

}  // namespace pcm::host
