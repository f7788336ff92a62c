#include "pcm/build/bins/packing_loops.h"

#include "pcm/build/bins/packing_loops_source.h"

namespace pcm {

const PackingLoops& packing_loops(SimdLevel level)
{
    static constexpr PackingLoops baseline{differing, least, subtract, move_bits, add};
    switch (level) {
        case SimdLevel::avx512:
            return packing_loops_avx512;
        case SimdLevel::avx2:
            return packing_loops_avx2;
        default:
            return baseline;
    }
}

}  // namespace pcm
