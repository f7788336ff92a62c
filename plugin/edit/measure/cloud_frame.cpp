#include "plugin/edit/measure/cloud_frame.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "plugin/host/placement.h"
#include "plugin/host/registry.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm::host {

namespace {

constexpr double float_rounding = 1e-5;  // a layer's matrix is in single precision

}  // namespace

Vec3d CloudFrame::to_cloud(const Vec3d& p) const
{
    if (!placement) return p;
    // The inverse of a turn with a scale is its transpose over the square of the scale.
    const Vec3d d = p - placement->target;
    const auto& m = placement->linear;
    return placement->pivot + (1 / (scale * scale)) * (d[0] * m[0] + d[1] * m[1] + d[2] * m[2]);
}

std::vector<Vec3d> CloudFrame::to_cloud(const std::vector<MeasuredPoint>& points) const
{
    std::vector<Vec3d> moved;
    for (const MeasuredPoint& point : points) moved.push_back(to_cloud(point.position));
    return moved;
}

CloudFrame cloud_frame(std::shared_ptr<PointCloud> cloud, const std::optional<Affine>& placement,
                       const std::string& label)
{
    CloudFrame frame{std::move(cloud), placement, 1};
    if (!placement) return frame;
    const auto& m = placement->linear;
    frame.scale = m[2][2];
    const double allowed = float_rounding * std::abs(frame.scale);
    const double tilt = std::max({std::abs(m[0][2]), std::abs(m[1][2]), std::abs(m[2][0]), std::abs(m[2][1]),
                                  std::abs(std::hypot(m[0][0], m[1][0]) - frame.scale), std::abs(m[0][0] - m[1][1]),
                                  std::abs(m[0][1] + m[1][0])});
    if (!(frame.scale > 0) || !(tilt <= allowed))
        throw Error(ErrorCode::invalid_argument, {},
                    "the matrix of the layer '" + label + "' tilts or stretches its cloud",
                    "Profiles and volumes need upright clouds: make a new tree of it with the filter Transform Point "
                    "Cloud, and measure that.");
    return frame;
}

CloudFrame cloud_frame(const MeshModel& layer)
{
    const auto tree = Registry::instance().drawn(layer);
    if (!tree)
        throw Error(ErrorCode::invalid_argument, {},
                    "the layer '" + layer.label().toStdString() + "' shows no point cloud");
    return cloud_frame(tree->cloud, placement_of(layer, *tree), layer.label().toStdString());
}

}  // namespace pcm::host
