// What two searches found in parts of a cloud, or among what one of them left, as one report.
#pragma once

#include "pcm/detect/detect.h"

#include <cstdint>
#include <vector>

namespace pcm {

// A point that both have found belongs to the shape of `others`, unless that is doubtful. Shapes that lose more
// than half of their points, or have fewer than least_points then, are left out. The cloud's values, and the first
// notes, are those of `rest`; primitives are in one order, and labelled, named and coloured by it. Throws what reading
// and writing labels throw.
DetectReport joined(const Tree& tree, DetectReport rest, DetectReport others, std::uint64_t least_points);

// Labels, colours and names in the order of the list, as each detection gives them.
void number_again(std::vector<Primitive>& primitives);

}  // namespace pcm
