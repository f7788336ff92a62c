#include "plugin/overlay/clip_count.h"

#include "pcm/gl/draw/view_clips.h"

#include <algorithm>
#include <utility>

namespace pcm::host {

void ClipCount::see(PointCloud& cloud, const std::vector<Clip>& clips)
{
    on_ = !clips.empty();
    const Tree* const tree = cloud.tree().get();
    std::string text = text_of(clips);
    if (text != text_ || tree != tree_) {
        text_ = std::move(text);
        tree_ = tree;
        hidden_.reset();
        return;
    }
    if (!on_ || hidden_) return;
    Query query;
    query.clips = clips;
    const Estimate shown = cloud.estimate(query);
    const auto all = static_cast<double>(cloud.info().points);
    hidden_ = Clipped{std::max(0.0, all - shown.points_expected), shown.points_least == shown.points_most};
}

}  // namespace pcm::host
