#include "pcm/ops/shared/camera_arguments.h"

#include "pcm/system/error.h"
#include "pcm/view/first_view.h"

#include <cstdio>

namespace pcm::ops {
namespace {

Vec3d vector_of(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

std::optional<CameraFrame> first_frame(const std::vector<std::shared_ptr<PointCloud>>& clouds, double angle,
                                       PictureSize size)
{
    if (!(angle > 0 && angle < 180)) return std::nullopt;  // an error elsewhere
    std::vector<Vec3d> points;
    std::vector<ScanPose> poses;
    for (const auto& cloud : clouds) {
        const std::vector<Vec3d> more = sampled_places(cloud->cache());
        points.insert(points.end(), more.begin(), more.end());
        if (clouds.size() == 1) poses = scan_poses(cloud->info().metadata);
    }
    const auto pose = first_view(points, poses, {angle, size.width, size.height, 0});
    if (!pose) return std::nullopt;
    CameraFrame frame;
    frame.eye = pose->eye;
    frame.target = pose->centre();
    frame.up = pose->up;
    frame.angle = angle;
    check(frame);
    return frame;
}

}  // namespace

PictureSize parse_size(const std::string& text)
{
    PictureSize size;
    int end = 0;
    if (std::sscanf(text.c_str(), "%6dx%6d%n", &size.width, &size.height, &end) != 2 ||
        static_cast<std::size_t>(end) != text.size() || size.width < 1 || size.height < 1)
        throw Error(ErrorCode::invalid_argument, {}, "--size '" + text + "' is not a size",
                    "write WIDTHxHEIGHT in pixels, as in 1280x720");
    return size;
}

void CameraArguments::declare(Arguments& arguments, const std::string& group)
{
    arguments.add("eye", eye)
        .count(3)
        .group(group)
        .label("Camera")
        .help("Camera position x y z, source coordinates: --eye 10 -40 30");
    arguments.add("target", target)
        .count(3)
        .group(group)
        .label("Target")
        .help("Point x y z that the camera looks at")
        .without("the middle of the cloud");
    arguments.add("up", up)
        .count(3)
        .group(group)
        .label("Up")
        .help("Direction that is up in the picture")
        .without("0 0 1");
    arguments.add("angle", angle)
        .unit("degrees")
        .group(group)
        .label("Angle of view")
        .help("Vertical angle of view")
        .without("45");
    arguments.add("orthographic", orthographic)
        .group(group)
        .label("Parallel projection")
        .help("Parallel projection instead of perspective");
    arguments.add("height", height)
        .unit("source units")
        .group(group)
        .label("Height of the view")
        .help("Parallel projection that shows this much from bottom to top: --height 25")
        .without("perspective");
}

CameraFrame CameraArguments::frame(const std::vector<std::shared_ptr<PointCloud>>& clouds, const Box3d& box,
                                 PictureSize size) const
{
    if (eye.empty() && target.empty() && up.empty() && !height && !orthographic)
        if (const auto frame = first_frame(clouds, angle.value_or(45), size)) return *frame;
    const bool parallel = orthographic || height;
    if (parallel && angle) throw ArgumentError("a parallel projection has no angle of view: leave out --angle");
    CameraFrame frame =
        overview_of(box, parallel ? std::nullopt : std::optional<double>(angle.value_or(45)), size.width, size.height);
    if (height) frame.height = *height;
    if (!up.empty()) frame.up = vector_of(up);
    const Vec3d whole_eye = frame.eye, whole_target = frame.target;
    if (!target.empty())
        frame.target = vector_of(target);
    else if (!eye.empty())
        frame.target = box.centre();
    if (!eye.empty())
        frame.eye = vector_of(eye);
    else
        for (std::size_t a = 0; a < 3; ++a) frame.eye[a] = frame.target[a] + (whole_eye[a] - whole_target[a]);
    check(frame);
    return frame;
}

}  // namespace pcm::ops
