// What errors along a scanner's rays do to a curved shape.
//
// A scanner's errors lie along its rays. Where a surface turns away from the scanner they move a point along the
// surface as well as off it, so that a least-squares fit of distances has a bias that more points do not lessen. With C
// the covariance of a point's error, n its normal, H the second derivatives of its distance by its place, J the
// derivatives of its distance by the shape's parameters, and J' those of J by the place, the equations sum J d = 0 are
// off by
//
//     sum over points of J tr(H C) / 2 + J' C n,
//
// the terms of second order (Box 1971), and the parameters by that divided by -sum of J J^T. A thin pipe of radius r
// seen from one side comes out too small by three to four times noise^2 / r.
//
// The direction u of a station's rays is about that of the mean normal of its points. How large a share of the errors'
// variance lies along it the distances show: their variance is s^2 ((1 - share) + share (u.n)^2). C is s^2 share u u^T.
#pragma once

#include "pcm/shapes/shape.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pcm {

struct PointOfStation {
    Vec3d place{};              // source coordinates
    std::uint32_t station = 0;  // any number
};

struct WithoutRayErrors {
    Shape shape;          // source coordinates
    double share = 0;     // share of the errors' variance along the rays, the most probable one; above 0
    double beam = 0;      // most probable standard deviation of the beam's light across it, source units
    Shape of_wider_beam;  // `shape` if the variance of that light were one standard deviation of its error larger
};

// The shape that is fitted to the points, without that bias and without what the width of the beam does
// (beam_width.h). Nothing for flat shapes, where errors do not lie along rays, and where the mean normal shows no
// direction: points all around a shape. `middle`: near the points; `extent`: about their size, above 0, source units;
// `widest_beam`: standard deviation of the light across the beam of a scanner of which nothing is known, above 0,
// source units. One thread; two microseconds a point.
std::optional<WithoutRayErrors> without_ray_errors(const Shape& shape, const std::vector<PointOfStation>& points,
                                                   const Vec3d& middle, double extent, double widest_beam);

}  // namespace pcm
