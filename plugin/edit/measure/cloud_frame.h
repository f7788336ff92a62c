// Between the scene (host/annotations.h) and the own coordinates of the cloud that a layer shows, for what is measured
// in plan and along the vertical. GUI thread.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/measure/measure.h"
#include "pcm/point_cloud.h"

#include <common/interfaces.h>

#include <memory>
#include <optional>
#include <vector>

namespace pcm::host {

struct CloudFrame {
    std::shared_ptr<PointCloud> cloud;
    // Of the layer's matrix: p -> scale * turned(p) + shift, about the vertical. Not set: the cloud is at its place.
    std::optional<Affine> placement;
    double scale = 1;

    Vec3d to_scene(const Vec3d& p) const { return placement ? (*placement)(p) : p; }
    Vec3d to_cloud(const Vec3d& p) const;
    std::vector<Vec3d> to_cloud(const std::vector<MeasuredPoint>& points) const;
};

// Throws Error(invalid_argument) for a layer that shows no cloud, and for a matrix that tilts the vertical, mirrors, or
// scales the axes differently: plan and height of the scene would not be those of the cloud.
CloudFrame cloud_frame(const MeshModel& layer);
// The same for a cloud with this placement. `label` is the layer's, for errors.
CloudFrame cloud_frame(std::shared_ptr<PointCloud> cloud, const std::optional<Affine>& placement,
                       const std::string& label);

}  // namespace pcm::host
