#include "pcm/bpc/column_loops_source.h"

namespace pcm {

const AllColumnLoops& avx512_column_loops()
{
    static constexpr AllColumnLoops all{loops<std::uint32_t>, loops<std::uint64_t>};
    return all;
}

}  // namespace pcm
