// What two searches found in parts of a cloud, or among what one of them left, as one report.
#pragma once

#include "pcm/detect/detect.h"

namespace pcm {

// No point has a label of both. The cloud's values, and the first notes, are those of `rest`; primitives are in one
// order, and labelled, named and coloured by it. Throws what reading and writing labels throw.
DetectReport joined(const Tree& tree, DetectReport rest, DetectReport others);

}  // namespace pcm
