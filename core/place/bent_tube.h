// A part of a torus with straight tubes of its radius at its ends, along the tangents there: an elbow and its pipes.
#pragma once

#include "pcm/cloud/numbers.h"
#include "pcm/shapes/shape.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace pcm {

struct BentTube {
    Shape torus;
    double from = 0, to = 0;              // the bend's ends, as angle_about()
    double from_error = 0, to_error = 0;  // their standard deviations; infinite where no points show an end
    double squares = 0;                   // sum of the squared distances of the points, those beyond as the farthest
    std::size_t on_tube = 0;              // points within the farthest distance
    double variance = 0;                  // mean of their squared distances
};

// Angle of a place about the torus's axis from a direction, which is not along the axis, from 0 to 2 pi, radians.
double angle_about(const Shape& torus, const Vec3d& start, const Vec3d& p);

struct BendEnds {
    double from = 0, to = 0;  // as angle_about()
};

// Several places of both ends between the first angle of the points and their last one.
std::vector<BendEnds> ends_between(double low, double high);

// The one with the least sum of squared distances, from a torus that is near, of which the direction `start` is in a
// gap of the points: Gauss-Newton steps (Levenberg, Marquardt) from each of these ends. Nothing where no step helps.
// `points`: source coordinates, at least 20, those of pipes beyond the torus among them; `farthest`: distance from
// which on they are of something else, source units. One thread; some ten milliseconds for 2000 points.
std::optional<BentTube> fit_bent_tube(const Shape& torus, const Vec3d& start, const std::vector<BendEnds>& ends,
                                      const std::vector<Vec3d>& points, double farthest = infinity);

}  // namespace pcm
