// The motion that brings points of one cloud to their partners in another: rotation and translation, optionally with
// one scale, by least squares.
//
// With p the moving and q the fixed points, w their weights, it minimises  sum w |q - (s R (p - cp) + cq)|^2  where cp
// and cq are the weighted centroids. R is the rotation of the unit quaternion that is the eigenvector of the largest
// eigenvalue of the symmetric 4 x 4 matrix of Horn (Closed-form solution of absolute orientation using unit
// quaternions, J. Opt. Soc. Am. A 4, 1987), improved by Gauss-Newton steps on the residuals; s is that of Umeyama
// (Least-squares estimation of transformation parameters between two point patterns, IEEE PAMI 13, 1991). All is
// computed relative to the centroids and to the size of the pairs, so that map coordinates cost no digits.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/cloud/geometry.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace pcm {

struct PointPair {
    Vec3d moving{}, fixed{};  // source coordinates of the two clouds
    double weight = 1;        // relative; 0: ignored by the fit, but has a residual
};

struct FitOptions {
    bool scale = false;  // fits a scale too
    // Standard deviation of a picked point from the place that was meant, source units: a quarter of the clouds'
    // spacing, for instance. Pairs that are no farther apart than a few times that are refused. 0: not known.
    double pick_error = 0;
};

struct RigidFit {
    Affine motion;           // moving -> fixed; its pivot is the moving pairs' centroid, its target the fixed ones'
    double scale = 1;        // scale of the motion; 1 unless asked for
    double pairs_scale = 1;  // the scale that the pairs suggest, applied or not: 0.3048 shows that units differ
    Vec3d axis{0, 0, 1};     // rotation axis, length 1
    double radians = 0;      // rotation angle, from 0 to pi, counter-clockwise as seen from the tip of the axis
    Vec3d shift{};           // shift of the centroid: target - pivot

    std::vector<Vec3d> offsets;     // fixed point minus moved point of each pair, source units
    std::vector<double> residuals;  // their lengths
    double rms = 0;                 // root of the weighted mean of their squares

    // Standard deviation of one coordinate of a pair: from the residuals and the degrees of freedom that the fit
    // leaves, or, if that is larger, the pick error of both points.
    double coordinate_error = 0;
    double angle_error = 0;  // standard deviation of the rotation about its least certain axis, radians
    Vec3d weakest_axis{};    // least certain rotation axis

    // Standard deviation of the place where the motion puts a point, in the direction where it is largest; source
    // units. To first order in the errors of the pairs, which are taken to be independent.
    double error_at(const Vec3d& moving) const;
    // The largest such value in a box of the moving cloud: at one of its corners.
    double largest_error(const Box3d& box) const;

    // Terms of error_at(): the covariance of translation at the centroid and of rotation, over coordinate_error^2.
    double variance_of_shift = 0;
    std::array<Vec3d, 3> covariance_of_rotation{};
};

// Throws Error(invalid_argument), which names the pairs and what to do: fewer than three pairs (of a weight above 0);
// numbers that are not finite, negative weights; points of one cloud that coincide, lie nearer together than they can
// be picked, or lie on one line (their spread across it is below three times the pick error, or a millionth of that
// along it): the rotation about that line is free; pairs that a mirror image fits and a motion does not; pairs that
// determine no rotation.
RigidFit fit_motion(const std::vector<PointPair>& pairs, const FitOptions& options = {});

}  // namespace pcm
