// The values of tuning.h by name. For benchmarks and tests: a program has no use for them.
#pragma once

#include "pcm/system/tuned_value.h"

#include <vector>

namespace pcm {

// In the order of tuning.h. Set them while nothing else works; the next fit at a place uses them.
std::vector<TunedValue> place_tuned_values();

}  // namespace pcm
