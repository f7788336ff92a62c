// Arguments that describe a camera.
#pragma once

#include "pcm/ops/argument.h"
#include "pcm/point_cloud.h"
#include "pcm/view/camera_path.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm::ops {

struct PictureSize {
    int width = 0, height = 0;
};
// Parses "WIDTHxHEIGHT". Throws Error(invalid_argument).
PictureSize parse_size(const std::string& text);

// eye, target, up, angle, orthographic, height.
struct CameraArguments {
    std::vector<double> eye, target, up;
    std::optional<double> angle, height;
    bool orthographic = false;

    void declare(Arguments& arguments, const std::string& group);
    bool given() const { return !eye.empty() || !target.empty() || !up.empty() || angle || height || orthographic; }
    // Without a camera, the first view of the clouds, as in a window (view/first_view.h). Otherwise what is not
    // given is as in an oblique view of the whole box. Throws ArgumentError for an angle of a parallel projection,
    // Error(invalid_argument), and what reading a sample of the clouds throws.
    CameraFrame frame(const std::vector<std::shared_ptr<PointCloud>>& clouds, const Box3d& box, PictureSize size) const;
};

}  // namespace pcm::ops
