#include "pcm/bpc/column_loops.h"

#include "pcm/bpc/column_loops_source.h"

namespace pcm {

const AllColumnLoops& column_loops(SimdLevel level)
{
    static constexpr AllColumnLoops baseline{loops<std::uint32_t>, loops<std::uint64_t>};
    switch (level) {
        case SimdLevel::avx512:
            return column_loops_avx512;
        case SimdLevel::avx2:
            return column_loops_avx2;
        default:
            return baseline;
    }
}

}  // namespace pcm
