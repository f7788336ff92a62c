// The errors of a shape in a cloud of several stations, which their registration has left apart.
//
// Where the station of each point is known, the spread of the stations is estimated from the surfaces around and from
// the shape itself (station_spread.h, station_survey.h). The effect of shifts of that size on the shape is added to the
// errors (station_sums.h), and that of turns by the spread over how far a station sees (station_reach.h); otherwise
// errors are those of the noise that is left within stations. A spread from few
// differences may be far too small, so that part is enlarged as Student's t is wider than a normal distribution
// (student_factor()). One station alone shifts a shape and does not change its size; the errors contain its shift where
// surfaces around show the spread, or it is given.
//
// Where the stations are unknown, only the given spread is added: whole to the position and to radii, and to angles in
// the ratio of their errors to that of the position, with the turn of a station that sees the whole cloud.
#pragma once

#include "pcm/fit/ray_errors.h"
#include "pcm/fit/station_sums.h"
#include "pcm/place/stations_around.h"
#include "pcm/query/point_set.h"
#include "pcm/shapes/primitive.h"
#include "pcm/system/progress.h"

#include <vector>

namespace pcm {

struct StationErrorOptions {
    double registration = 0;  // known spread of a station along each axis, source units; 0: it is not known
    unsigned threads = 0;     // 0: one per processor
    ProgressFunction progress;
    double metres_per_unit = 1;  // metres per source unit, for the width of a scanner's beam (beam_width.h)
    // Doubt a good curved fit that the points of one station leave by more than smooth surfaces around explain.
    bool doubt_noise = false;
};

// Takes the bias of errors along the rays and of the beam's width from the shape (ray_errors.h), and changes its
// errors: the ray errors of unknown stations are those of one. Sets `stations`, and doubts a good fit whose size is
// then uncertain. `points`: those of the primitive; `around`: its stations, around the place that was picked.
// `agreement`: factor by which its errors were enlarged because neighbours share errors (RefittedShape::agreement);
// becomes the factor within stations. Streams, four times. The result depends neither on threads nor on memory. Throws
// Error(cancelled), and what reading throws.
void add_station_errors(const PointSet& points, StationsAround& around, const StationErrorOptions& options,
                        double& agreement, Primitive& primitive);

// The steps of that, for many shapes whose points are streamed past together. `primitive` has `stations` with their
// source, number and registration. Each doubts a good fit whose size is then uncertain.
//
// `reach`: StationSurvey::reach, source units.
//
// Adds the registration that is given, where the stations are unknown or too many.
void add_unknown_spread(double reach, Primitive& primitive);
// Adds the effect of shifts of that spread. The sums are those of its points: they determine the shape, and the
// stations are StationEvidence::most_stations at most. `agreement` becomes `within`, the factor within stations.
void add_known_spread(const StationSums& sums, const StationSpread& found, double reach, double within,
                      double& agreement, Primitive& primitive);
// Takes the bias of errors along the rays from a curved shape, and adds what may be left of it to its errors.
// `sample`: some of its points.
void leave_ray_errors(const std::vector<PointOfStation>& sample, double metres_per_unit, Primitive& primitive);
// Enlarges the threshold by how far points in that box may be from the shape because it was moved.
void keep_within(const Shape& before, const Box3d& box, ShapeFit& fit);

}  // namespace pcm
