#include "pcm/place/extreme_points.h"

#include "pcm/shapes/flat_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pcm {

void ExtremePoints::Ends::add(double value, const Vec3d& p)
{
    if (value < least) least = value, at_least = p;
    if (value > largest) largest = value, at_largest = p;
}

ExtremePoints::ExtremePoints(const Shape& shape, const Vec3d& middle)
    : kind_(shape.kind), point_(shape.point), middle_(middle), frame_(shape.axis)
{
    if (kind_ == ShapeKind::cylinder) around_.resize(sectors);
}

void ExtremePoints::add(const Vec3d& p)
{
    if (kind_ == ShapeKind::plane) {
        hull_.push_back(p);
        if (hull_.size() >= most_) keep_hull();
        return;
    }
    const Vec3d d = p - point_;
    along_.add(kind_ == ShapeKind::cylinder ? dot(frame_.axis, d) : 0, p);  // a sphere's bounds need one point
    if (kind_ != ShapeKind::cylinder) return;
    const double angle = frame_.angle_of(d);
    const auto sector = static_cast<std::size_t>(std::max(0.0, (angle + pi) / (2 * pi) * sectors));
    around_[std::min(sector, sectors - 1)].add(angle, p);
}

void ExtremePoints::add(const ExtremePoints& other)
{
    for (const Vec3d& p : other.points()) add(p);
}

void ExtremePoints::keep_hull()
{
    std::vector<Vec2d> flat;
    for (const Vec3d& p : hull_) flat.push_back({dot(frame_.u, p - middle_), dot(frame_.v, p - middle_)});
    const FlatPoints points(flat);
    std::vector<Vec3d> kept;
    for (const std::uint32_t place : points.convex_hull()) kept.push_back(hull_[points[place].index]);
    hull_ = std::move(kept);
    most_ = std::max<std::size_t>(128, 2 * hull_.size());
}

std::vector<Vec3d> ExtremePoints::points() const
{
    if (kind_ == ShapeKind::plane) {
        ExtremePoints hull = *this;
        if (!hull.hull_.empty()) hull.keep_hull();
        return hull.hull_;
    }
    std::vector<Vec3d> kept;
    const auto keep = [&](const Ends& ends) {
        if (!(ends.least <= ends.largest)) return;
        kept.push_back(ends.at_least);
        if (ends.least < ends.largest) kept.push_back(ends.at_largest);
    };
    keep(along_);
    for (const Ends& ends : around_) keep(ends);
    return kept;
}

}  // namespace pcm
