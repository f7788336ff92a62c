#include "pcm/fit/block_loops.h"

#include "pcm/system/cpu.h"

namespace pcm {
namespace {

const BlockLoops& loops_of(SimdLevel level)
{
    switch (level) {
#ifdef PCM_HAVE_AVX
        case SimdLevel::avx512:
            return avx512_block_loops();
        case SimdLevel::avx2:
            return avx2_block_loops();
#endif
        default:
            return baseline_block_loops();
    }
}

}  // namespace

const BlockLoops& block_loops()
{
    static const BlockLoops& loops = loops_of(simd_level());
    return loops;
}

}  // namespace pcm
