// A selection of points, from the text of a filter's or exporter's parameters.
#pragma once

#include "pcm/cloud/selection.h"

#include <QString>

namespace pcm::host {

// `box`: six numbers, the smallest x y z and the largest x y z in source coordinates, or empty. `where`: conditions as
// for parse_condition(), separated by semicolons, or empty. Throws Error(invalid_argument), which says what was found
// and what was expected.
Selection parse_selection(const QString& box, const QString& where);

}  // namespace pcm::host
