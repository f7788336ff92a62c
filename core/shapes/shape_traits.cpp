#include "pcm/shapes/shape_traits.h"

namespace pcm {

#define PCM_SHAPE_ROW(name) &name##_shape,
const ShapeTraits* const shape_rows[] = {PCM_SHAPE_KINDS(PCM_SHAPE_ROW)};
#undef PCM_SHAPE_ROW

const std::vector<std::reference_wrapper<const ShapeTraits>>& shape_kinds()
{
#define PCM_SHAPE_ROW(name) name##_shape,
    static const std::vector<std::reference_wrapper<const ShapeTraits>> rows{PCM_SHAPE_KINDS(PCM_SHAPE_ROW)};
#undef PCM_SHAPE_ROW
    return rows;
}

}  // namespace pcm
