// The face of a plate at a place, where the nearest points are those of both faces.
//
// On a thin plate that a scanner sees better from behind, most of the nearest points lie on the other face: the plane
// of these does not pass through the place, and curved shapes pass through both. The two faces are parallel, so the
// plane of most points shows the direction of the one at the place.
#pragma once

#include "pcm/place/local_fit.h"

#include <optional>

namespace pcm {

// The nearest points of a place where planes are looked for. Nothing where a threshold or a neighbourhood is given, and
// where planes are not among the kinds. Throws what points_near() throws.
std::optional<NearPoints> near_faces(const PointCloud& cloud, const Vec3d& place, const LocalFitOptions& options);

// The plane through the place of those of its nearest points that lie on it, if nearly all of the others lie on one
// parallel plane, and both hold the noise. Thresholds are the noise of the nearest points, which may be that of both
// faces, a half and a quarter of it. Nothing where near_faces() has none. Throws what points_near() and fit_shape()
// throw.
std::optional<LocalFit> fit_face(const PointCloud& cloud, const Vec3d& place, const LocalFitOptions& options);

}  // namespace pcm
