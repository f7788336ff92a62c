#include "pcm/bpc/column_loops.h"

#include "pcm/system/cpu.h"

namespace pcm {

const AllColumnLoops& column_loops()
{
    switch (simd_level()) {
#if defined(PCM_HAVE_AVX)
        case SimdLevel::avx512:
            return avx512_column_loops();
        case SimdLevel::avx2:
            return avx2_column_loops();
#endif
        default:
            return baseline_column_loops();
    }
}

}  // namespace pcm
