#include "pcm/build/levels/poisson_loops_source.h"

namespace pcm {

const PoissonLoops& avx2_poisson_loops()
{
    static constexpr PoissonLoops all{first_open};
    return all;
}

}  // namespace pcm
