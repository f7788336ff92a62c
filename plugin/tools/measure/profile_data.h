// A profile for its plot.
#pragma once

#include "pcm/measure/profile.h"
#include "plugin/tools/measure/profile_plot.h"

#include <QString>

#include <memory>
#include <vector>

namespace pcm::host {

struct ProfileData {
    std::shared_ptr<PointCloud> cloud;
    ProfileOptions options;  // in the scene, where the layer's matrix puts the cloud; without progress
    QString title, unit;
    std::vector<PlotPoint> points;  // station and height in the scene
    QString words;                  // how many points, and what is left out
};

// Reads at most `most` points; of more, a coarser level. The colours are those of the cloud's rgb, else of its classes,
// else grey. Any thread. Throws what sample_profile() throws.
void read_profile(ProfileData& data, std::size_t most, const ProgressFunction& progress);

}  // namespace pcm::host
