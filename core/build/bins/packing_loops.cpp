#include "pcm/build/bins/packing_loops.h"

#include "pcm/system/cpu.h"

namespace pcm {

const PackingLoops& packing_loops()
{
    switch (simd_level()) {
#if defined(PCM_HAVE_AVX)
        case SimdLevel::avx512:
            return avx512_packing_loops();
        case SimdLevel::avx2:
            return avx2_packing_loops();
#endif
        default:
            return baseline_packing_loops();
    }
}

}  // namespace pcm
