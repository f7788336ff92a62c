#include "pcm/detect/bend_points.h"

#include <algorithm>
#include <cmath>

namespace pcm {

BendFrame frame_of(const TubeEnd& a, const TubeEnd& b, const piping::AxesMeeting& meeting)
{
    BendFrame frame;
    frame.at = 0.5 * ((a.place + meeting.to_a * a.out) + (b.place + meeting.to_b * b.out));
    frame.inwards = normalised(-1 * (a.out + b.out));
    frame.axis = normalised(cross(a.out, -1 * b.out));
    frame.turn = meeting.turn;
    return frame;
}

BendPoints::BendPoints(const BendFrame& frame, const std::vector<Vec3d>& points, double tube, double threshold)
    : half_(std::tan(frame.turn / 2)),
      secant_(1 / std::cos(frame.turn / 2)),
      least_cosine_(std::cos(frame.turn / 4)),
      tube_(tube),
      threshold_(threshold)
{
    const Vec3d across = cross(frame.axis, frame.inwards);
    for (const Vec3d& p : points) {
        const Vec3d d = p - frame.at;
        const double height = dot(d, frame.axis);
        if (std::fabs(height) <= tube + threshold)
            points_.push_back({p, -dot(d, frame.inwards), dot(d, across), height});
    }
}

std::size_t BendPoints::count(double tangent) const
{
    const auto is_there = [&](const Placed& p) { return is_on(p, tangent / half_); };
    return static_cast<std::size_t>(std::count_if(points_.begin(), points_.end(), is_there));
}

std::vector<Vec3d> BendPoints::on_arc(double tangent) const
{
    std::vector<Vec3d> found;
    for (const Placed& p : points_)
        if (is_on(p, tangent / half_)) found.push_back(p.position);
    return found;
}

bool BendPoints::is_on(const Placed& p, double bend) const
{
    const double out = p.outwards + bend * secant_;  // from the arc's centre
    const double away = std::sqrt(out * out + p.across * p.across);
    if (!(out > least_cosine_ * away)) return false;
    const double from_circle = away - bend;
    return std::fabs(std::sqrt(from_circle * from_circle + p.height * p.height) - tube_) <= threshold_;
}

}  // namespace pcm
