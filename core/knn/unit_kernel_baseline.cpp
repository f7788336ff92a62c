#include "pcm/knn/unit_kernel_source.h"

namespace pcm {

const UnitKernels& baseline_unit_kernels()
{
    static constexpr UnitKernels kernels{search_block<std::int32_t>, search_block<std::int64_t>};
    return kernels;
}

}  // namespace pcm
