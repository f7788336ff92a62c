// unit_search.h by the FLANN library, for comparison: single-precision offsets from the middle of the positions decide
// which neighbours are found. Distances are exact ones of those neighbours.
#pragma once

#include "pcm/knn/unit_search.h"

namespace pcm {

// Throws Error(unsupported) where the shared object with FLANN is not installed, Error(invalid_argument) if FLANN
// refuses the points. Slow where very many points lie at one place.
std::unique_ptr<UnitSearch> make_flann_search(SearchPositions positions);

// Why make_flann_search() would throw; empty: it would not.
std::string why_no_flann();

// Whether the backend is installed, without loading it: for what is only shown.
bool has_flann();

}  // namespace pcm
