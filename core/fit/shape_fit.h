// Fits one shape to points of which many may belong to something else.
//
// Samples of the minimum number of points that determine a shape are drawn, each is scored by all points, and a sample
// better than all before is improved by least squares at once (locally optimised RANSAC, Chum, Matas, Kittler 2003).
// The winner is polished by least squares of geometric distances in double until steps are small relative to the
// errors. Points that are near the surface by chance, as those beyond the threshold show, are ignored or count less,
// and where the threshold is within the noise least squares looks up to twice as far. All is computed relative to the
// points and to their extent.
#pragma once

#include "pcm/cloud/numbers.h"
#include "pcm/fit/fit_points.h"
#include "pcm/shapes/fitted_shape.h"
#include "pcm/shapes/shape.h"
#include "pcm/system/progress.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// How samples are drawn, scored and given up.
enum class Estimator : std::uint8_t {
    ransac,   // most inliers (Fischler, Bolles 1981)
    msac,     // minimum sum of min(d^2, threshold^2) (Torr, Zisserman 2000)
    mlesac,   // greatest likelihood of a Gaussian and uniform outliers (Torr, Zisserman 2000)
    prosac,   // msac; points whose neighbours lie in a plane are drawn first (Chum, Matas 2005)
    rransac,  // ransac; a sample is scored by all points only if another point is near it (Matas, Chum 2004)
    rmsac,    // msac with that test
};
struct EstimatorTraits {
    Estimator estimator;
    const char* name;   // "msac"
    const char* label;  // "MSAC"
    const char* description;
};
const std::vector<EstimatorTraits>& estimators();  // in the order of the enumerators
const EstimatorTraits& traits_of(Estimator estimator);
std::optional<Estimator> estimator_of(const std::string& name);

enum class FitBackend : std::uint8_t {
    own,
    pcl,  // the Point Cloud Library on coordinates relative to the points; for comparison
};
std::string why_no_pcl();  // why FitBackend::pcl would be refused; empty: it would not

struct ShapeFitOptions {
    ShapeKind kind = ShapeKind::plane;
    Estimator estimator = Estimator::msac;
    // Maximum distance of an inlier, source units; 0: from the points' local noise down the one whose points are least
    // likely to be there by chance. `iterations` is then the maximum number of samples of each that is tried.
    double threshold = 0;
    std::uint32_t iterations = 10000;  // maximum number of samples
    double probability = 0.99;         // probability of a sample without outliers; ends the search early; 0 < p < 1
    double seconds = 0;                // time limit: ends the search with the best so far; 0: no limit
    std::uint64_t seed = 1;            // the same seed and points give the same result where time does not end it
    // Radii (of a torus: its tube's) outside are not considered, source units.
    double least_radius = 0, largest_radius = infinity;
    // Largest angle between an inlier's normal and the surface's, radians; pi / 2 or more: normals are not compared.
    double normal_angle = 4;
    FitBackend backend = FitBackend::own;
    ProgressFunction progress;  // may cancel: Error(cancelled)
};

// The shape of most points. Never throws because of what the points are: see FitVerdict. Throws Error(invalid_argument)
// for options out of range, Error(unsupported) for a backend that is not installed, Error(cancelled). One thread; no
// state between calls.
ShapeFit fit_shape(const FitPoints& points, const ShapeFitOptions& options);

struct RefineOptions {
    // Points farther than this are ignored (decided again in each step); infinite: all count.
    double threshold = infinity;
    double normal_angle = 4;  // as in ShapeFitOptions
    unsigned most_steps = 50;
};

// Least-squares fit of the geometric distances, from a shape that is near. As fit_shape(), without samples.
ShapeFit refine_shape(const FitPoints& points, const Shape& start, const RefineOptions& options = {});

// An inlier's maximum distance, from the noise of the points' own surface: three standard deviations of points from
// curved surfaces through neighbourhoods that are wide relative to the noise. Within a factor of two where up to a
// third of the points are outliers, and more where the surface is dense next to them. 0 where the points do not show it
// (all in one place, for instance).
double automatic_threshold(const FitPoints& points);

// Gives the points unit normals by planes through their nearest neighbours; 0 0 0 where these are on one line.
void estimate_normals(FitPoints& points, std::size_t neighbours = 16);

}  // namespace pcm
