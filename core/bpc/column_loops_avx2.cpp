#include "pcm/bpc/column_loops_source.h"

namespace pcm {

const AllColumnLoops column_loops_avx2{loops<std::uint32_t>, loops<std::uint64_t>};

}  // namespace pcm
