#include "pcm/build/nodes/size_loops.h"

#include "pcm/system/cpu.h"

namespace pcm {

const SizeLoops& size_loops()
{
    switch (simd_level()) {
#if defined(PCM_HAVE_AVX)
        case SimdLevel::avx512:
            return avx512_size_loops();
        case SimdLevel::avx2:
            return avx2_size_loops();
#endif
        default:
            return baseline_size_loops();
    }
}

}  // namespace pcm
