// Points within the outlines of planes that belong to nothing.
#pragma once

#include "pcm/detect/assign_points.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace pcm {

struct OutlinePointsOptions {
    double spacing = 0;              // spacing of the cloud, source units
    std::uint64_t least_points = 0;  // points of a primitive
    std::function<void()> check;     // called at times; may throw
};

// Gives planes' parts whose number of points is about the minimum of a primitive the points that lie on them, within
// their convex outlines and one spacing around these, but belong to nothing: where a surface is thin or narrow, normals
// out of 16 neighbours show those of what is next to it. Not to parts of surfaces that continue, as ground does, nor
// among points that belong to nothing, as in trees. `assigned`: with points (SurfacePart::some). One thread. Throws
// what reading, `labels` and options.check throw.
void take_outline_points(const ChosenPoints& points, const std::vector<Hypothesis>& hypotheses,
                         AssignedPoints& assigned, PointLabels& labels, const OutlinePointsOptions& options);

}  // namespace pcm
