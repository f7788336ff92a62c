#include "pcm/io/pipe/held_reader.h"

#include "pcm/io/pipe/batch_shape.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace pcm {

std::size_t copy_some(const PointBatch& from, std::size_t first, const Schema& schema, std::size_t most, PointBatch& to)
{
    const std::size_t count =
        std::min({std::max<std::size_t>(most, 1), from.size - first, points_that_fit_a_batch(schema)});
    shape_batch(to, schema, from.gridded, count);
    for (std::size_t a = 0; a < 3; ++a) {
        if (from.gridded)
            std::copy_n(from.grid_xyz[a].data() + first, count, to.grid_xyz[a].data());
        else
            std::copy_n(from.xyz[a].data() + first, count, to.xyz[a].data());
    }
    for (std::size_t k = 0; k < to.attributes.size(); ++k) {
        const std::size_t bytes = to.attributes[k].point_bytes();
        if (count) std::memcpy(to.attributes[k].data(), from.attributes[k].data() + first * bytes, count * bytes);
    }
    return count;
}

HeldReader::HeldReader(std::shared_ptr<const PointBatch> points, FileInfo info)
    : points_(std::move(points)), info_(std::move(info))
{
    info_.points = points_->size;
    info_.points_known = true;
}

bool HeldReader::read(PointBatch& batch, std::size_t max_points)
{
    next_ += copy_some(*points_, next_, info_.schema, max_points, batch);
    return batch.size > 0;
}

double HeldReader::fraction_read() const
{
    return points_->size ? static_cast<double>(next_) / static_cast<double>(points_->size) : 1;
}

}  // namespace pcm
