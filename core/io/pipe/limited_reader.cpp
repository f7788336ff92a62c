#include "pcm/io/pipe/limited_reader.h"

#include "pcm/cloud/vector.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {

LimitedReader::LimitedReader(std::unique_ptr<PointReader> cloud, double largest)
    : cloud_(std::move(cloud)), largest_(largest), info_(cloud_->info())
{
    if (!(largest > 0) || !std::isfinite(largest))
        throw Error(ErrorCode::invalid_argument, {},
                    "the largest coordinate must be a positive number, not " + exact(largest));
    info_.points_known = false;
    if (!info_.promised_box) return;
    Box3d& box = *info_.promised_box;
    for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] = std::max(box.min[a], -largest_);
        box.max[a] = std::min(box.max[a], largest_);
    }
    if (box.empty()) info_.promised_box.reset();
}

bool LimitedReader::read(PointBatch& batch, std::size_t max_points)
{
    const Grid* const grid = info_.grid ? &*info_.grid : nullptr;
    // A batch without a kept point is not the end.
    while (cloud_->read(batch, max_points)) {
        kept_.clear();
        for (std::size_t i = 0; i < batch.size; ++i) {
            Vec3d p;
            for (std::size_t a = 0; a < 3; ++a)
                p[a] = grid ? grid->to_source(batch.grid_xyz[a][i], a) : batch.xyz[a][i];
            if (std::fabs(p[0]) > largest_ || std::fabs(p[1]) > largest_ || std::fabs(p[2]) > largest_) {
                if (info_.points_left_out++ == 0) first_ = p;
            } else {
                kept_.push_back(static_cast<std::uint32_t>(i));
            }
        }
        if (kept_.size() < batch.size) keep_points(batch, kept_);
        if (batch.size) return true;
    }
    take_notes();
    shape_batch(batch, info_.schema, info_.grid.has_value(), 0);
    return false;
}

// Readers count on the way what they drop.
void LimitedReader::take_notes()
{
    info_.notes = cloud_->info().notes;
    info_.metadata = cloud_->info().metadata;
    if (info_.points_left_out)
        info_.notes.push_back(points_text(info_.points_left_out) + " with a coordinate beyond " + exact(largest_) +
                              (info_.points_left_out == 1 ? " was" : " were") + " left out, the first at " +
                              exact(first_));
}

}  // namespace pcm
