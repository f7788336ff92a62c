#include "pcm/build/levels/poisson_loops.h"

#include "pcm/system/cpu.h"

namespace pcm {

const PoissonLoops& poisson_loops()
{
    switch (simd_level()) {
#if defined(PCM_HAVE_AVX)
        case SimdLevel::avx512:
            return avx512_poisson_loops();
        case SimdLevel::avx2:
            return avx2_poisson_loops();
#endif
        default:
            return baseline_poisson_loops();
    }
}

}  // namespace pcm
