// What was found in two parts of a cloud, as one report.
#pragma once

#include "pcm/detect/detect.h"

namespace pcm {

// The cloud's values, and the first notes, are those of `rest`; a note says what those of `quiet` are. Throws what
// reading and writing labels throw.
DetectReport joined(const Tree& tree, DetectReport rest, DetectReport quiet);

}  // namespace pcm
