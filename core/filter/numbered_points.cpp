#include "pcm/filter/numbered_points.h"

#include <algorithm>
#include <cstddef>

namespace pcm {

NumberedPoints::NumberedPoints(std::shared_ptr<const Tree> tree, std::uint64_t points, unsigned chunks_ahead)
{
    // The first level that is not taken whole, if there is one.
    const std::vector<LevelSummary> levels = tree->level_summaries();
    std::size_t part = 0;
    while (part < levels.size() && levels[part].points_to_here <= points) ++part;
    std::optional<std::uint16_t> level;
    if (part < levels.size()) {
        level = static_cast<std::uint16_t>(part);
        all_ = levels[part].points;
        wanted_ = points - (levels[part].points_to_here - all_);
    }
    cloud_ = std::make_unique<TreeReader>(tree, level, Selection(), chunks_ahead);
    info_ = cloud_->info();
    if (!level) return;
    info_.points = points;
    for (const Node& node : tree->nodes()) {
        const std::uint32_t to_here = node.points_to_level(part);
        const std::uint32_t before = part ? node.points_to_level(part - 1) : 0;
        if (before > 0) runs_.push_back({before, true});
        if (to_here > before) runs_.push_back({to_here - before, false});
    }
}

bool NumberedPoints::read(PointBatch& batch, std::size_t max_points)
{
    while (run_ < runs_.size()) {
        const Run& run = runs_[run_];
        if (!cloud_->read(batch, std::min<std::size_t>(max_points, run.points - in_run_))) return false;
        in_run_ += static_cast<std::uint32_t>(batch.size);
        if (!run.whole) thin(batch);
        if (in_run_ == run.points) {
            ++run_;
            in_run_ = 0;
        }
        if (batch.size > 0) return true;
    }
    return cloud_->read(batch, max_points);
}

void NumberedPoints::thin(PointBatch& batch)
{
    kept_.clear();
    for (std::size_t i = 0; i < batch.size; ++i) {
        due_ += wanted_;
        if (due_ < all_) continue;
        due_ -= all_;
        kept_.push_back(static_cast<std::uint32_t>(i));
    }
    keep_points(batch, kept_);
}

}  // namespace pcm
