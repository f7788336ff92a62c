#include "pcm/build/nodes/size_loops_source.h"

namespace pcm {

const SizeLoops& baseline_size_loops()
{
    static constexpr SizeLoops all{find_distances<float>, find_distances<double>, find_middles};
    return all;
}

}  // namespace pcm
