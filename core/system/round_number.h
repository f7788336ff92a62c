// Round numbers for defaults that people read: 1, 2 or 5 times a power of ten.
#pragma once

namespace pcm {

// The one whose ratio to the value is nearest to 1: 0.2 for 0.25, 5 for 4. The value itself where it is not positive
// and finite, or has no such neighbour (below 1e-300, above 1e300).
double round_number(double value);

}  // namespace pcm
