// Fits one shape to points of which many may belong to something else.
//
// Samples of the least number of points that determine a shape are drawn, each is scored by all points, and a sample
// better than all before is improved by least squares at once (locally optimised RANSAC, Chum, Matas, Kittler 2003).
// The winner is polished by least squares of geometric distances in double until steps are small beside the errors.
// Points that are near the surface by chance, as those beyond the threshold show, take no part or count less, and where
// the threshold is within the noise least squares looks up to twice as far. All is computed relative to the points and
// to their extent.
#pragma once

#include "pcm/fit/fit_points.h"
#include "pcm/fit/shape.h"
#include "pcm/system/progress.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// How samples are drawn, scored and given up.
enum class Estimator : std::uint8_t {
    ransac,   // most inliers (Fischler, Bolles 1981)
    msac,     // least sum of min(d^2, threshold^2) (Torr, Zisserman 2000)
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
    // Largest distance of an inlier, source units; 0: from the points' local noise down the one whose points are least
    // there by chance. `iterations` is then the most samples of each that is tried.
    double threshold = 0;
    std::uint32_t iterations = 10000;  // the most samples
    double probability = 0.99;         // that a sample without outliers was drawn; ends the search early; 0 < p < 1
    double seconds = 0;                // ends the search with the best so far; 0: no limit
    std::uint64_t seed = 1;            // the same seed and points give the same result where time does not end it
    // Radii (of a torus: its tube's) outside are not considered, source units.
    double least_radius = 0, largest_radius = std::numeric_limits<double>::infinity();
    // Largest angle between an inlier's normal and the surface's, radians; pi / 2 or more: normals are not compared.
    double normal_angle = 4;
    FitBackend backend = FitBackend::own;
    ProgressFunction progress;  // may cancel: Error(cancelled)
};

enum class FitVerdict : std::uint8_t {
    good,
    doubtful,  // there is a result, and a reason to doubt it: `issue` and `message`; its errors say how far
    refused,   // there is none
};

// Why a fit is doubtful or refused.
enum class FitIssue : std::uint8_t {
    none,
    too_few_points,
    not_finite,    // a coordinate is NaN or infinite
    coincident,    // all points at one place
    collinear,     // all points on one line
    coplanar,      // all points in one plane, where a curved surface was asked for
    thin_arc,      // the points cover too little of the surface for their noise, or for errors that neighbours share
    no_consensus,  // no sample has enough inliers; doubtful: almost as many points are beside the surface as on it, or
                   // as many would be near some surface by chance
    out_of_range,  // of the asked radii
    not_converged,
    other_surface,  // the points are those of another surface: a ring or strip of it, or of a kind that fits far better
};
const char* name_of(FitIssue issue);      // "thin arc"
const char* name_of(FitVerdict verdict);  // "good"

// Standard deviations, to first order in independent errors of the inliers along the normal; infinite where the points
// do not determine it, 0 where the shape has no such number. Of shapes that are almost planes errors are larger where
// those of neighbouring points are alike.
struct ShapeErrors {
    double position = 0;  // of the plane along its normal and of an axis across it, at the inliers' middle; of the
                          // centre of sphere and torus and of the cone's apex; in the direction where it is largest;
                          // source units
    double angle = 0;     // of the normal or axis about its least certain direction, radians
    double radius = 0;    // source units
    double second = 0;    // radians (cone) or source units (torus)
};

struct ShapeFit {
    FitVerdict verdict = FitVerdict::refused;
    FitIssue issue = FitIssue::none;
    std::string message;  // a sentence for people: what, and what to do; empty when good
    Shape shape;          // source coordinates
    ShapeErrors errors;
    double condition = 0;  // of the normal equations, each parameter in units of the shape's extent
    double threshold = 0;  // that was used, source units
    double noise = 0;      // standard deviation of one inlier's distance: rms with the degrees of freedom
    double rms = 0;        // of the inliers' distances
    std::uint64_t inliers = 0;
    std::vector<std::uint8_t> is_inlier;  // a byte per point, 1 or 0; empty without points in memory
    std::uint64_t iterations = 0;         // samples drawn
    double seconds = 0;                   // wall time

    bool has_shape() const { return verdict != FitVerdict::refused; }
};

// The shape of most points. Never throws because of what the points are: see FitVerdict. Throws Error(invalid_argument)
// for options out of range, Error(unsupported) for a backend that is not installed, Error(cancelled). One thread; no
// state between calls.
ShapeFit fit_shape(const FitPoints& points, const ShapeFitOptions& options);

struct RefineOptions {
    // Points farther than this take no part (decided again in each step); infinite: all take part.
    double threshold = std::numeric_limits<double>::infinity();
    double normal_angle = 4;  // as in ShapeFitOptions
    unsigned most_steps = 50;
};

// Least squares of the geometric distances from a shape that is near. As fit_shape(), without samples.
ShapeFit refine_shape(const FitPoints& points, const Shape& start, const RefineOptions& options = {});

// An inlier's largest distance, from the noise of the points' own surface: three standard deviations of points from
// curved surfaces through neighbourhoods that are wide beside the noise. Within a factor of two where up to a third of
// the points are outliers, and more where the surface is dense beside them. 0 where the points say nothing (all in one
// place, say).
double automatic_threshold(const FitPoints& points);

// Gives the points unit normals by planes through their nearest neighbours; 0 0 0 where these are on one line.
void estimate_normals(FitPoints& points, std::size_t neighbours = 16);

}  // namespace pcm
