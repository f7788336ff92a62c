// A picked point in words.
#pragma once

#include "plugin/scene/picker.h"

#include <QString>

#include <vector>

namespace pcm::host {

struct PickedLine {
    QString name, value;
};

// The layer's label, source coordinates with all digits and, where a matrix moves the layer, those of the scene, the
// point's number, spacing and grid step in source units, and all attributes.
std::vector<PickedLine> lines_of(const Picked& picked, const QString& layer);

// The label next to the point in the view: source coordinates, a line each, to a hundredth of the points' spacing or
// finer.
QString label_of(const Picked& picked);

// For the log: "x y z, layer", with the digits of lines_of().
QString logged_text(const std::vector<PickedLine>& lines);

// Names and values, separated by a tab; one line each.
QString copied_text(const std::vector<PickedLine>& lines);

}  // namespace pcm::host
