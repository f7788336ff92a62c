#include "pcm/build/bins/packing_loops_source.h"

namespace pcm {

const PackingLoops packing_loops_avx512{differing, least, subtract, move_bits, add};

}  // namespace pcm
