#include "pcm/gl/draw/frame_cost.h"

#include "pcm/gl/tuning.h"

#include <algorithm>

namespace pcm {

FrameCost::FrameCost(Frame& frame, const SceneSelection& selection, const std::vector<SceneSelection::Place>& places)
    : frame_(frame)
{
    strokes_.reserve(places.size());
    for (const SceneSelection::Place& place : places) {
        const FrameCloud& cloud = frame.clouds[place.tree];
        strokes_.push_back({place, cloud.feed->find(selection.trees[place.tree].wanted[place.index].node), 0, 0, 0});
    }
    for (std::size_t t = 0; t < frame.clouds.size(); ++t) {
        frame.begin(frame.clouds[t]);
        for (Stroke& stroke : strokes_) {
            if (stroke.place.tree != t) continue;
            stroke.first_part = parts_.size();
            stroke.vertices = frame.splats.preview(*stroke.entry, parts_);
            stroke.parts = parts_.size() - stroke.first_part;
        }
        frame.splats.end();
    }
}

FrameWork FrameCost::work(const Stroke& stroke, const FrameCloud::Gap& gap) const
{
    const CloudStyle& style = frame_.clouds[stroke.place.tree].style;
    const bool own = traits_of(style.splats).reads_radius && stroke.entry->format.radius;
    const double radius =
        own ? static_cast<double>(style.radius_scale) * static_cast<double>(stroke.entry->typical_radius) : 0;
    const double least = own ? 1.0 : std::max(1.0, static_cast<double>(style.point_size_px));
    const auto most_filled = static_cast<double>(fill_of(gap.spacing_px, style));
    // A splat cannot cover more than the whole picture.
    const double largest = std::max(frame_.picture.target.width(), frame_.picture.target.height());
    FrameWork work{stroke.entry->points, stroke.vertices, 0, 0};
    for (std::size_t i = stroke.first_part; i < stroke.first_part + stroke.parts; ++i) {
        const auto& [points, pixels_per_unit] = parts_[i];
        const double filled = std::min(most_filled, gl_tuning().splats.fill * gap.spacing * pixels_per_unit);
        const double side = std::min(std::max({least, 2 * radius * pixels_per_unit, filled}), largest);
        work.splats += points;
        work.pixels += points * side * side;
    }
    return work;
}

}  // namespace pcm
