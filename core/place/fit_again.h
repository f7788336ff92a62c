// Fits that are made again: farther along a bend, of one kind alone, or before the radius of a pipe changes.
#pragma once

#include "pcm/cloud/clip.h"
#include "pcm/place/fit_at.h"

#include <functional>
#include <optional>
#include <vector>

namespace pcm {

// The answer at another place, or for other kinds, or in a part of the cloud.
using FitAgain = std::function<FittedPrimitive(const Vec3d& place, const std::vector<ShapeKind>& kinds,
                                               const std::optional<Clip>& part)>;

// Where a pipe bends at the place, the elbow if that has the place. `on_bend`: a point of the bend farther along it.
// Throws what the fit throws.
FittedPrimitive or_elbow(FittedPrimitive found, const Vec3d& place, const Vec3d& on_bend,
                         const std::vector<ShapeKind>& kinds, const FitAgain& fit);

// Where the place is on a straight pipe behind the end of an elbow, that pipe; else the elbow, which is doubtful.
// Throws what the fit throws.
FittedPrimitive or_pipe(FittedPrimitive found, const Vec3d& place, const FitAgain& fit);

// Kinds are compared by the points around the place, where a piece of an elbow is a cylinder, and one of a reducer,
// too; followed through the cloud, that leaves the surface. Then the shape of a kind of higher rank (choose_kind()),
// where that can be followed and explains its own points better. Not where the points found have more than this
// noise, as those of several surfaces, are as few as those of leaves, or the shape is doubtful for its own sake:
// uneven, or uncertain. Throws what the fit throws.
FittedPrimitive or_higher_kind(FittedPrimitive found, const Vec3d& place, double most_noise,
                               const std::vector<ShapeKind>& kinds, const FitAgain& fit, unsigned threads);

// The pipe at the place alone, where it was followed through a reducer to a pipe of another radius (radius_step.h);
// where its verdict is not good, or the radius changes at the place, the first answer, doubted. `spread`: distance
// between stations after registration, source units. Throws what the fit throws.
FittedPrimitive or_one_radius(FittedPrimitive found, const Vec3d& place, double spread, const FitAgain& fit,
                              unsigned threads);

}  // namespace pcm
