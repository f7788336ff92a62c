// How many points of a cloud a clip box hides, for the text in the view.
#pragma once

#include "pcm/cloud/clip.h"
#include "pcm/point_cloud.h"
#include "plugin/overlay/overlay.h"

#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

class ClipCount {
public:
    // The clips of each paint event. They are counted once they are the same in two, so that moving a box is not slower
    // for large trees.
    void see(PointCloud& cloud, const std::vector<Clip>& clips);
    bool is_on() const { return on_; }
    const std::optional<Clipped>& hidden() const { return hidden_; }

private:
    bool on_ = false;
    std::string text_;
    const Tree* tree_ = nullptr;  // tree of the clips seen last; compared only
    std::optional<Clipped> hidden_;
};

}  // namespace pcm::host
