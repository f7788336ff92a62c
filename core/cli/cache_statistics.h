// The statistics of a cache, as text and as JSON.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/cli/common.h"

namespace pcm::cli {

Json cache_json(const L2Statistics& statistics);
void print(const L2Statistics& statistics);

}  // namespace pcm::cli
