// Points chosen by text that a user writes into parameters.
#pragma once

#include "pcm/cloud/selection.h"

#include <QString>

namespace pcm::host {

// `box`: six numbers, the smallest x y z and the largest x y z, source coordinates, or empty. `where`: conditions, as
// parse_condition() has them, separated by semicolons, or empty. Throws Error(invalid_argument), saying what was found
// and what was expected.
Selection parse_selection(const QString& box, const QString& where);

}  // namespace pcm::host
