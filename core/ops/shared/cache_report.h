// Statistics of a cache of chunks, as JSON and as text.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/ops/result.h"

namespace pcm::ops {

Json cache_json(const L2Statistics& statistics);
void put_cache_lines(Result& result, const L2Statistics& statistics);

}  // namespace pcm::ops
