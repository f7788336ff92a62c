#include "pcm/detect/elbow_pieces.h"

#include "pcm/detect/hypotheses.h"
#include "pcm/detect/tuning.h"
#include "pcm/place/near_points.h"

#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t most_read = 20000;  // points around a piece

double length_of(const Primitive& cylinder) { return cylinder.bounds.to - cylinder.bounds.from; }

}  // namespace

bool ElbowPieces::may_be(std::size_t index) const
{
    const Primitive& one = primitives_[index];
    return one.fit.shape.kind == ShapeKind::cylinder &&
           length_of(one) <= detect_tuning().elbows.max_piece * one.fit.shape.radius;
}

bool ElbowPieces::is_of(std::size_t index, const Primitive& torus)
{
    if (!may_be(index)) return false;
    const ShapeFit& own = primitives_[index].fit;
    const double reach = torus.fit.shape.radius + torus.fit.shape.second + own.shape.radius;
    const Vec3d middle =
        own.shape.point + 0.5 * (primitives_[index].bounds.from + primitives_[index].bounds.to) * own.shape.axis;
    if (length(middle - torus.fit.shape.point) > reach) return false;
    const std::vector<Vec3d>& points = points_of(index);
    return !points.empty() && rms_distance(torus.fit.shape, points) <=
                                  detect_tuning().elbows.max_piece_rms * rms_distance(own.shape, points);
}

const std::vector<Vec3d>& ElbowPieces::points_of(std::size_t index)
{
    const auto [found, is_new] = points_.try_emplace(index);
    if (!is_new) return found->second;
    const Primitive& one = primitives_[index];
    const Shape& shape = one.fit.shape;
    const double half = length_of(one) / 2, middle = one.bounds.from + half;
    NearOptions near;
    near.radius = std::hypot(half, shape.radius + one.fit.threshold);
    near.most = most_read;
    near.limit = limit_;
    for (const Vec3d& p : points_near(cloud_, shape.point + middle * shape.axis, near).points.sources())
        if (std::fabs(dot(p - shape.point, shape.axis) - middle) <= half && distance_to(shape, p) <= one.fit.threshold)
            found->second.push_back(p);
    return found->second;
}

}  // namespace pcm
