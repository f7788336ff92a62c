// The part of space in which points can be hit by a ray, and how near its boxes are.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/pick/point_picker.h"
#include "pcm/tree/tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace pcm {

class PickCone {
public:
    PickCone(const PickRay& ray, const PickOptions& options, const TreeInfo& info);

    // The largest radius of splats of this level, source units.
    double limit(std::size_t level) const
    {
        return level < limits_.size() ? limits_[level] : std::numeric_limits<double>::infinity();
    }
    double reach_at(double t, double radius) const
    {
        const double pixel = ray_.pixel_at(t);
        return std::min(std::max(radius, options_.tolerance_px * pixel), options_.largest_px * pixel);
    }
    // A lower bound of the depth of hits in the box by points whose splats have at most this radius; absent when there
    // cannot be any. Rounding is allowed for.
    std::optional<double> least_depth(const Box3d& box, double radius) const;

    struct Place {
        double t, square;  // position along the ray and square of s
    };
    Place place_of(const Vec3d& p) const
    {
        const Vec3d d = (p - ray_.centre) - ray_.start;
        const double t = dot(ray_.direction, d);
        const Vec3d across = d - t * ray_.direction;
        return {t, dot(across, across)};
    }
    bool shows(double t) const { return t >= ray_.begin && t <= ray_.end; }
    double depth(const Place& place, double reach) const
    {
        return place.square > 0 ? place.t + place.square / (2 * reach) : place.t;
    }

private:
    const PickRay& ray_;
    const PickOptions& options_;
    double size_ = 0;             // the largest number in the equations of the ray
    std::vector<double> limits_;  // largest radius of each level
};

}  // namespace pcm
