#include "pcm/build/nodes/size_loops_source.h"

namespace pcm {

const SizeLoops size_loops_avx512{find_distances<float>, find_distances<double>, find_middles};

}  // namespace pcm
