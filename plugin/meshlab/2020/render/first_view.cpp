#include "plugin/meshlab/2020/render/first_view.h"

#include "plugin/meshlab/2020/trackball_pose.h"

namespace pcm::host {

std::vector<Vec3d> placed_vertices(const MeshModel& layer)
{
    std::vector<Vec3d> points;
    for (const CVertexO& vertex : layer.cm.vert) {
        if (vertex.IsD()) continue;
        const Point3m p = layer.cm.Tr * vertex.cP();
        points.push_back({static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    }
    return points;
}

std::optional<vcg::Similarityf> first_view(const std::vector<Vec3d>& points, float fov, int width, int height,
                                           int covered, const std::vector<ScanPose>& poses)
{
    if (is_orthographic(fov)) return std::nullopt;
    const auto pose = pcm::first_view(points, poses, {static_cast<double>(fov), width, height, covered});
    if (!pose) return std::nullopt;
    return trackball_of(*pose, fov);
}

}  // namespace pcm::host
