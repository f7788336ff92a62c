// The values of tuning.h by name. For benchmarks and tests: a program has no use for them.
#pragma once

#include "pcm/system/tuned_value.h"

#include <vector>

namespace pcm {

// In the order of tuning.h. To be set while nothing else works.
std::vector<TunedValue> piping_tuned_values();

}  // namespace pcm
