// Parts of surfaces as they are in the cloud, whatever hides, divides and shifts their points.
#pragma once

#include "pcm/detect/assign_points.h"
#include "pcm/detect/station_shifts.h"

#include <functional>
#include <vector>

namespace pcm {

struct WholePartOptions {
    double spacing = 0, noise = 0, threshold = 0;  // values of the cloud, source units
    bool uses_stations = true;
    bool is_first = true;         // points that are left of a search are neither plates nor within outlines
    std::function<void()> check;  // called at times, by the calling thread; may throw
};

// As assign_points(), with parts of planes joined (part_joining.h), thin plates divided into their faces
// (plate_faces.h), parts joined again by points that are where their stations most probably were, and points given to
// planes that lie within their outlines (outline_points.h). Parts keep no points (SurfacePart::some). `shifts` of the
// stations are found where none are known. With a step in assign.sample nothing is joined: assign_points() alone.
AssignedPoints assign_whole(const ChosenPoints& points, const std::vector<Box3i>& units,
                            std::vector<Hypothesis>& hypotheses, const AssignOptions& assign,
                            const WholePartOptions& options, StationShifts& shifts, PointLabels& labels);

}  // namespace pcm
