// The answer by the points next to the place alone, where a shape of more points is not good: parts of a few dozen
// points between others, as rims of flanges, knobs and short plates.
#pragma once

#include "pcm/place/corner_at_place.h"
#include "pcm/place/fit_again.h"
#include "pcm/place/fit_at.h"
#include "pcm/place/near_points.h"
#include "pcm/shapes/shape.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace pcm {

// How well shapes explain the points next to a place: the logarithm of the likelihood ratio of a point, on average,
// between a mixture in equal parts of the shape's points, whose distances are normal with that noise, and of points
// anywhere in the ball about the place, and the latter alone (the mixture of Torr and Zisserman 2000, MLESAC); less
// half the logarithm of the points for each of the shape's numbers (BIC, Schwarz 1978). The sum of that over balls of
// `near_place.smallest_ball` points and more, so that points count more the nearer they are.
class NearLikelihood {
public:
    // `points`: the nearest first, source coordinates. `noise` > 0: source units.
    NearLikelihood(const Vec3d& place, std::vector<Vec3d> points, double noise);

    double of(const Shape& shape) const;
    double of(const Corner& corner) const;  // its widest face and that at its border, if one is known; else that alone

private:
    double of(const std::vector<double>& distances, double numbers) const;

    const Vec3d place_;
    const std::vector<Vec3d> points_;
    const double noise_;
};

// The answer for a neighbourhood of `count` points, followed through the cloud or not.
using FitOfNearest = std::function<FittedPrimitive(std::size_t count, bool grow)>;

// Where `found` is not good, the shape of a small neighbourhood (`near_place.smallest` points and more) that explains
// the points next to the place far better, has the nearest one, and whose sizes are certain: as it is followed, or,
// where it then explains them worse, as it is, doubtful. `near`: the nearest points; `noise`: one standard deviation of
// theirs, source units; 0: unknown, `found` stays. A curved shape counts where it explains them better than a corner
// (two faces that meet) explains them. Throws what the fits throw.
FittedPrimitive or_nearest(FittedPrimitive found, const Vec3d& place, const NearPoints& near, double noise,
                           const FitOfNearest& fit);

// Where `found` is a sphere that is not good, the cylinder at the place if that explains the points next to it nearly
// as well, doubtful: a band, as the rim of a flange, is of both, and most are of cylinders. The rest as above.
FittedPrimitive or_band(FittedPrimitive found, const Vec3d& place, const NearPoints& near, double noise,
                        const FitAgain& fit);

}  // namespace pcm
