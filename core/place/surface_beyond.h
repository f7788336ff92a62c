// Whether a shape's points are a piece of another surface, which the threshold cuts: a ring of a pipe that a sphere
// touches, a strip of it that a plane does.
//
// Such points end where the cloud's surface continues beyond the threshold, beside them rather than above them, and
// their distances from the shape are those of the other surface: larger than the noise, or alike at neighbours. Points
// of a true shape end where the surface ends, or turns off; noise, clutter and walls are above points of it. And points
// that are near a shape by chance are as many as those beside it.
#pragma once

#include "pcm/shapes/shape.h"

#include <vector>

namespace pcm {

struct SurfaceBeyond {
    // Points within `beyond_thresholds` where the surface continues, per point within the threshold.
    double continued = 0;
    // Of the squared distances within the threshold, what is left in those of means of neighbours; noise leaves a
    // seventeenth.
    double bend = 0;
    // Points within the threshold that those farther than twice of it let expect, were they spread evenly, per point
    // there is.
    double chance = 0;

    // `noise`: of the fit, in units of that of the surface near the place; 0: unknown.
    bool is_piece(double noise) const;
    bool is_by_chance() const;
};

// `points`: up to beyond_thresholds (grow_shape.h) * threshold from the shape, connected, about as dense everywhere;
// source coordinates. `threshold` > 0, source units. One thread; memory: some 150 bytes per point.
SurfaceBeyond surface_beyond(const Shape& shape, double threshold, const std::vector<Vec3d>& points);

}  // namespace pcm
