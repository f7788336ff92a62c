#include "pcm/detect/lone_pipe.h"

#include "pcm/cloud/numbers.h"
#include "pcm/detect/sagitta.h"
#include "pcm/detect/tuning.h"
#include "pcm/fit/pipe_start.h"
#include "pcm/shapes/axis_frame.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

// The smallest angle about a cylinder's axis that holds this share of the points, by the share, radians: few points of
// another surface at its edge do not count as an arc.
double arc_of(const Shape& cylinder, const std::vector<Vec3d>& points, double share)
{
    const AxisFrame frame(cylinder.axis);
    std::vector<double> angles;
    for (const Vec3d& p : points)
        angles.push_back(std::atan2(dot(p - cylinder.point, frame.v), dot(p - cylinder.point, frame.u)));
    std::sort(angles.begin(), angles.end());
    const std::size_t count = angles.size(), held = static_cast<std::size_t>(share * static_cast<double>(count));
    for (std::size_t i = 0; i < held; ++i) angles.push_back(angles[i] + 2 * pi);
    double least = 2 * pi;
    for (std::size_t i = 0; i < count; ++i) least = std::min(least, angles[i + held] - angles[i]);
    return std::min(least / share, 2 * pi);
}

// Few other free points are within a few thresholds of its surface.
bool is_alone(const SurfaceSample& sample, const ShapeGrowth& growth, const FoundShape& pipe,
              const std::vector<Vec3d>& points)
{
    const PipeTuning& tuned = detect_tuning().pipes;
    const double most = tuned.alone_thresholds * pipe.threshold;
    Box3d box;
    for (const Vec3d& p : points) box.extend(p + sample.origin);
    std::size_t others = 0;
    for_points_near(sample, box, pipe.shape, most, [&](std::uint32_t i) {
        const double distance = distance_to(pipe.shape, sample.at[i]);
        others += growth.is_free(i) && distance > pipe.threshold && distance <= most;
    });
    return static_cast<double>(others) <= tuned.max_others * static_cast<double>(points.size());
}

}  // namespace

double visible_threshold(const Shape& shape, const std::vector<Vec3d>& points, double most)
{
    const double sagitta = sagitta_of(shape, turn_of(shape, points));
    return std::min(most, sagitta / detect_tuning().search.sagitta_thresholds);
}

bool is_lone_pipe(const SurfaceSample& sample, const ShapeGrowth& growth, const FoundShape& pipe, double turn)
{
    const PipeTuning& tuned = detect_tuning().pipes;
    const std::vector<Vec3d> points = places_of(sample, pipe.points);
    const double arc = arc_of(pipe.shape, points, tuned.arc_share);
    const double least = detect_tuning().search.sagitta_thresholds * pipe.threshold;
    const bool bends = arc >= tuned.min_turn || sagitta_of(pipe.shape, arc) >= least;
    return visible_threshold(pipe.shape, points, pipe.threshold) >= pipe.threshold && arc >= turn && bends &&
           extent_along(pipe.shape.axis, points) >= tuned.min_length * pipe.shape.radius &&
           is_alone(sample, growth, pipe, points);
}

}  // namespace pcm
