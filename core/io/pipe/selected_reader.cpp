#include "pcm/io/pipe/selected_reader.h"

#include "pcm/io/pipe/batch_shape.h"

#include <algorithm>
#include <utility>

namespace pcm {

SelectedReader::SelectedReader(std::unique_ptr<PointReader> cloud, const Selection& selection)
    : cloud_(std::move(cloud)), selector_(selection, cloud_->info().schema), info_(cloud_->info())
{
    info_.schema = selector_.kept_schema();
    if (!selector_.tests_points()) return;
    info_.points_known = false;
    if (info_.promised_box && selector_.bounds()) {
        Box3d& box = *info_.promised_box;
        for (std::size_t a = 0; a < 3; ++a) {
            box.min[a] = std::max(box.min[a], selector_.bounds()->min[a]);
            box.max[a] = std::min(box.max[a], selector_.bounds()->max[a]);
        }
        if (box.empty()) info_.promised_box.reset();
    }
}

bool SelectedReader::read(PointBatch& batch, std::size_t max_points)
{
    const Grid* grid = info_.grid ? &*info_.grid : nullptr;
    const std::vector<std::size_t>& kept = selector_.kept();
    const bool all_attributes = kept.size() == cloud_->info().schema.size();
    // A batch without a selected point is not the end.
    while (cloud_->read(all_attributes ? batch : whole_, max_points)) {
        PointBatch& whole = all_attributes ? batch : whole_;
        seen_ += whole.size;
        selector_.apply(whole, grid);
        if (whole.size == 0) continue;
        if (all_attributes) return true;
        shape_batch(batch, info_.schema, whole.gridded, whole.size);
        for (std::size_t a = 0; a < 3; ++a) {
            std::swap(batch.grid_xyz[a], whole.grid_xyz[a]);
            std::swap(batch.xyz[a], whole.xyz[a]);
        }
        for (std::size_t k = 0; k < kept.size(); ++k) std::swap(batch.attributes[k], whole.attributes[kept[k]]);
        return true;
    }
    info_.notes = cloud_->info().notes;  // readers count on the way what they drop
    info_.points_left_out = cloud_->info().points_left_out;
    shape_batch(batch, info_.schema, info_.grid.has_value(), 0);
    return false;
}

void SelectedReader::seek(std::uint64_t index)
{
    if (!seekable()) return PointReader::seek(index);
    cloud_->seek(index);
}

}  // namespace pcm
