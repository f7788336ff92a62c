#include "pcm/fit/shape_distances.h"

#include "pcm/fit/models/shape_model.h"

namespace pcm {

void signed_distances(const Shape& shape, const double* x, const double* y, const double* z, std::size_t count,
                      double* out)
{
    model_of(shape.kind).distances(shape, x, y, z, count, out);
}

}  // namespace pcm
