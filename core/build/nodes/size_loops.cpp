#include "pcm/build/nodes/size_loops.h"

#include "pcm/build/nodes/size_loops_source.h"

namespace pcm {

const SizeLoops& size_loops(SimdLevel level)
{
    static constexpr SizeLoops baseline{find_distances<float>, find_distances<double>, find_middles};
    switch (level) {
        case SimdLevel::avx512:
            return size_loops_avx512;
        case SimdLevel::avx2:
            return size_loops_avx2;
        default:
            return baseline;
    }
}

}  // namespace pcm
