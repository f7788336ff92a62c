// Pipe runs: cylinders and elbows (arcs of tori) of one radius that continue each other, as one pipe with a centre
// line.
#pragma once

#include "pcm/shapes/primitive.h"

#include <cstddef>
#include <string>
#include <vector>

namespace pcm {

// A straight line, or an arc of less than a whole circle. Source units and radians.
struct CentrePiece {
    Vec3d from{}, to{};
    double angle = 0;         // turn of the arc; 0: straight
    double radius = 0;        // the bend's radius, of an arc
    Vec3d centre{}, axis{};   // an arc runs counter-clockwise about the unit vector `axis` from `from` to `to`
    bool is_measured = true;  // a shape shows it; else it joins two shapes tangentially

    bool is_bend() const { return angle > 0; }
    double length() const;
};

struct PipeRun {
    std::string name;                     // "Pipe run 2"
    std::vector<const Primitive*> parts;  // two or more, along the run
    std::vector<CentrePiece> line;        // each piece begins where the one before it ends
    bool is_closed = false;               // the last piece ends where the first one begins
    // Weighted mean of the parts' radii, and its standard deviation: the larger of what the parts' own errors and what
    // their differences say. The error is 0 where that of a part is not known.
    double radius = 0, radius_error = 0;
    // Standard deviation of length(), to first order (piping/run_errors.h): free ends are as uncertain as points are
    // apart there, bends that no shape shows by what pipes may have of them. 0: not known.
    double length_error = 0;

    double length() const;      // along the centre line
    std::size_t bends() const;  // number of arcs
};

// Runs of two parts and more, in the order in which the list has their first ones, each from that of its two ends that
// is the earlier one there; hidden primitives are ignored, and each primitive is a part of one run at most. Which ends
// continue each other is decided by the shapes' errors and the limits of tuning.h:
//
// - the same radius;
// - two straight pipes with one axis, one pipe tangent to an elbow's circle where its arc ends, or two elbows with a
//   common tangent there; what lies between their measured ends is bridged along that tangent;
// - two straight pipes whose axes meet beyond both ends at about the same distance, where no elbow is: an arc is
//   assumed that touches both. So lists of detected shapes, which have no tori, have runs with bends.
//
// Where several continue one end the better ones are taken first; the straight continuation behind a tee is taken
// before an elbow that branches off there. Which parts are joined depends neither on the order of the list, but for
// ties, nor on the direction of axes. The primitives must outlive the runs. Any thread.
std::vector<PipeRun> pipe_runs(const std::vector<const Primitive*>& primitives);
std::vector<PipeRun> pipe_runs(const std::vector<Primitive>& primitives);

// The centre line as a polyline: ends of pieces, and as many points of each arc as keep it within `chord` (source
// units) of the polyline; 0: a hundredth of the pipe's radius. A closed one does not repeat its first point. Throws
// Error(invalid_argument) for a chord that is negative or not finite.
std::vector<Vec3d> centre_points(const PipeRun& run, double chord = 0);

// "2 bends of 90 and 45 degrees", "1 bend of 90 degrees, without an elbow in the list", "no bends".
std::string bends_text(const PipeRun& run);
// Names of the parts along the run: "Pipe 1, Elbow 1, Pipe 2".
std::string parts_text(const PipeRun& run);
// "'Pipe 1' and 2 others are doubtful"; empty: all parts are good.
std::string doubt_text(const PipeRun& run);

}  // namespace pcm
