#include "pcm/filter/aligned_reader.h"

#include "pcm/filter/common_schema.h"
#include "pcm/io/pipe/batch_shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {

AlignedReader::AlignedReader(std::unique_ptr<PointReader> cloud, const Alignment& alignment)
    : cloud_(std::move(cloud)), to_(alignment), from_(cloud_->info()), schema_(alignment.schema)
{
    if (to_.source_id) schema_.add(*to_.source_id);
}

const FileInfo& AlignedReader::info() const
{
    info_ = cloud_->info();
    info_.schema = schema_;
    if (to_.grid) info_.grid = to_.grid;
    return info_;
}

// Moves integers; the result is exact, what changes is the rounding of the coordinate in double.
void AlignedReader::move_to_grid(PointBatch& batch)
{
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t factor = to_.map.factor[a], shift = to_.map.shift[a];
        double most = 0;
        for (std::size_t i = 0; i < batch.size; ++i) {
            const std::int64_t before = batch.grid_xyz[a][i], after = before * factor + shift;
            most = std::max(most, std::fabs(to_.grid->to_source(after, a) - from_.grid->to_source(before, a)));
            batch.grid_xyz[a][i] = static_cast<std::int32_t>(after);
        }
        *to_.rounding = std::max(*to_.rounding, most);
    }
}

bool AlignedReader::read(PointBatch& batch, std::size_t max_points)
{
    const bool more = cloud_->read(batch_, max_points);
    shape_batch(batch, schema_, batch_.gridded, batch_.size);
    if (!more) return false;
    for (std::size_t a = 0; a < 3; ++a) {
        std::swap(batch.grid_xyz[a], batch_.grid_xyz[a]);
        std::swap(batch.xyz[a], batch_.xyz[a]);
    }
    if (to_.grid && !(*to_.grid == *from_.grid)) move_to_grid(batch);
    for (std::size_t k = 0; k < to_.schema.size(); ++k) {
        if (to_.schema[k] == from_.schema[k])
            std::swap(batch.attributes[k], batch_.attributes[k]);
        else
            convert_column(from_.schema[k], batch_.attributes[k], to_.schema[k], batch.attributes[k]);
    }
    if (to_.source_id) {
        Column& ids = batch.attributes.back();
        if (ids.type() == ScalarType::u16)
            std::fill_n(ids.as<std::uint16_t>(), batch.size, static_cast<std::uint16_t>(to_.number));
        else
            std::fill_n(ids.as<std::uint32_t>(), batch.size, to_.number);
    }
    return true;
}

}  // namespace pcm
