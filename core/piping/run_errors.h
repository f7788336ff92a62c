// Radius and standard deviations of a run of tubes: what pipe_runs() (pipe_run.h) states of its own line.
#pragma once

#include "pcm/shapes/primitive.h"
#include "pcm/shapes/tube.h"

#include <array>
#include <vector>

namespace pcm::piping {

struct ValueWithError {
    double value = 0, error = 0;  // error 0: not known
};

// Weighted mean of the radii with weights of 1 / error^2 where all errors are known, else of 1. Its error is the larger
// of what the tubes' own errors and what their differences say.
ValueWithError run_radius(const std::vector<const Tube*>& tubes);

// A bend of a run: the arc between two straight lines.
struct RunBend {
    double turn = 0;             // radians
    double arc = 0;              // length of the arc, source units
    double tangent_error = 0;    // standard deviation of where the arc begins and ends along its tangents, source units
    double place_error = 0;      // offset of both tangents across themselves, source units
    double direction_error = 0;  // angle error of both tangents times the bend's radius, source units
};

// Standard deviation of the length of a centre line, source units. A line whose tangents meet at a turn t, each `u`
// long up to there, is 2 u - u t / tan(t / 2) shorter along the arc than along the tangents, so that
//
//     error^2 = sum over free ends of end^2
//             + sum over bends of ((2 - t / tan(t / 2)) tangent)^2 + (k place)^2 + (k^2 direction)^2
//                               + ((place^2 + tangent^2) / arc)^2,
//
// k = tan(t / 2), at most 2: behind a turn of more than 127 degrees the tangents do not meet where the arc is. The last
// term is of second order, of tangents that miss each other in two directions, and the largest one in bends of few
// degrees.
double length_error(const std::vector<RunBend>& bends, const std::array<double, 2>& free_ends);

// How uncertain the end of a part is along its centre line, source units: the mean spacing of its points, were they all
// around it, and their noise. Half of the points of a pipe that is seen from one side are as far apart.
double end_error(const Primitive& primitive, const Tube& tube);

}  // namespace pcm::piping
