#include "pcm/fit/block_loops_source.h"

namespace pcm {

const BlockLoops& avx2_block_loops()
{
    static constexpr BlockLoops loops = all_loops();
    return loops;
}

}  // namespace pcm
