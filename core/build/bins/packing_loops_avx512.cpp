#include "pcm/build/bins/packing_loops_source.h"

namespace pcm {

const PackingLoops& avx512_packing_loops()
{
    static constexpr PackingLoops all{differing, least, subtract, move_bits, add};
    return all;
}

}  // namespace pcm
