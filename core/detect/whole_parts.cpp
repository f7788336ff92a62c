#include "pcm/detect/whole_parts.h"

#include "pcm/detect/outline_points.h"
#include "pcm/detect/part_joining.h"
#include "pcm/detect/plate_faces.h"

namespace pcm {
namespace {

// Divides plates by the stations that see their faces, and joins parts of planes that the stations' shifts have kept
// apart.
void use_stations(const ChosenPoints& points, std::vector<Hypothesis>& hypotheses, AssignedPoints& assigned,
                  const AssignOptions& assign, const WholePartOptions& options, const PartJoinOptions& join,
                  StationShifts& shifts, PointLabels& labels)
{
    if (!shifts.stations) shifts.stations = std::make_shared<PointStations>(points.tree());
    const SeenPlanes seen(points, assigned, hypotheses, labels, shifts,
                          {options.noise, assign.sample.cell, assign.threads, options.check});
    shifts = seen.shifts();
    if (!shifts.are_known()) return;
    for (const SeenPlane& plane : seen.planes())
        assigned.parts[plane.part].some = places_of(shifts.corrected(plane.points));
    if (options.is_first)
        divide_plates(points, seen, assigned, hypotheses, labels, {options.noise, options.spacing, options.check});
    join_parts(assigned, hypotheses, join);
}

}  // namespace

AssignedPoints assign_whole(const ChosenPoints& points, const std::vector<Box3i>& units,
                            std::vector<Hypothesis>& hypotheses, const AssignOptions& assign,
                            const WholePartOptions& options, StationShifts& shifts, PointLabels& labels)
{
    if (assign.sample.step > 0) return assign_points(points, units, hypotheses, assign, &labels);
    const PartJoinOptions join{options.spacing, options.noise, options.threshold, assign.least_points,
                               assign.normal_angle};
    AssignedPoints assigned = assign_joined(points, units, hypotheses, assign, join, &labels);
    if (options.uses_stations) use_stations(points, hypotheses, assigned, assign, options, join, shifts, labels);
    if (options.is_first)
        take_outline_points(points, hypotheses, assigned, labels,
                            {options.spacing, assign.least_points, options.check});
    for (SurfacePart& part : assigned.parts) part.some = {};  // nothing looks at them any more
    return assigned;
}

}  // namespace pcm
