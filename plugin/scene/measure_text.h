// Measures as text for panels, labels and the clipboard.
#pragma once

#include "pcm/measure/measure.h"

#include <QString>

#include <string>

namespace pcm::host {

// The coordinates of a point, without the noise that the steps of its grid have in double: 636798.2 of 63679820 * 0.01.
QString coordinates_of(const MeasuredPoint& point);

// What lists and labels say of it: its first number, or the coordinates of a point.
QString value_of(const Measure& measure, const std::string& unit);

// All values of a measure as lines "name<tab>value", and its points.
QString text_of(const Measure& measure, const std::string& unit);

}  // namespace pcm::host
