// The errors of a shape in a cloud of several stations, which their registration has left apart.
//
// Where the points say from which station they were measured, the spread of the stations is estimated from the
// surfaces around and the shape itself (station_spread.h, station_survey.h), and what stations that are shifted so far
// do to the shape is added to the errors (station_sums.h), which are otherwise those of the noise that is left within
// stations. From few differences a spread may be far too small, so that part is enlarged as Student's t is wider
// than a normal distribution (student_factor()). One station alone shifts a shape and does not change its size; its
// shift is contained where surfaces around show the spread, or it is given.
//
// Where nothing says the station the given spread alone is added: to the position and to radii whole, to angles
// as their errors are to that of the position.
#pragma once

#include "pcm/query/point_set.h"
#include "pcm/shapes/primitive.h"
#include "pcm/system/progress.h"

namespace pcm {

struct StationErrorOptions {
    double registration = 0;  // known spread of a station along each axis, source units; 0: it is not known
    Vec3d place{};            // around which surfaces are looked at
    unsigned threads = 0;     // 0: one per processor
    ProgressFunction progress;
};

// Changes the fit's errors, sets `stations`, and doubts a good fit of which the size is then uncertain. `points`: of
// the primitive. `agreement`: how many times as large its errors were made because those of neighbours are alike
// (RefittedShape::agreement); becomes that within stations. Streams, three times. The result depends neither on threads
// nor on memory. Throws Error(cancelled), and what reading throws.
void add_station_errors(const PointSet& points, const StationErrorOptions& options, double& agreement,
                        Primitive& primitive);

}  // namespace pcm
