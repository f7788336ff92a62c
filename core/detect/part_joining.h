// Parts of one plane or pipe that are apart because something before it hides what lies between them.
#pragma once

#include "pcm/detect/assign_points.h"

#include <vector>

namespace pcm {

struct PartJoinOptions {
    double spacing = 0, noise = 0, threshold = 0;  // values of the cloud, source units
    std::uint64_t least_points = 0;                // minimum of a primitive; cylinders with fewer are joined
    double normal_angle = 0;                       // maximum angle between two parts' normals, radians
};

// Makes one part of those that lie on one plane, or on one cylinder on which one of them has too few points by itself
// (surface_of_both.h). Not joined are points that fill the threshold evenly or are some of those around them, as in
// trees, and planes over several surfaces, which have more noise than the cloud. The hypothesis of a joined part, with
// its surface, is added to `hypotheses`. `assigned`: with points (SurfacePart::some); parts without, and of other
// kinds, stay. One thread; O(n log^2 n) for n parts of which each is near few others. The order of parts matters only
// where some have as many points as others.
void join_parts(AssignedPoints& assigned, std::vector<Hypothesis>& hypotheses, const PartJoinOptions& options);

// As assign_points(), with parts joined that alone may have a tenth of the points of one of interest; parts that stay
// so small are in the result, too.
AssignedPoints assign_joined(const ChosenPoints& points, const std::vector<Box3i>& units,
                             std::vector<Hypothesis>& hypotheses, AssignOptions assign, const PartJoinOptions& join,
                             PointLabels* labels);

}  // namespace pcm
