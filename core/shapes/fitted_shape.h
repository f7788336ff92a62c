// A shape that was fitted to points: what a fit results in, how sure it is, and why it may be doubted.
#pragma once

#include "pcm/shapes/shape.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

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
    no_consensus,  // no sample has enough inliers; doubtful: almost as many points are next to the surface as on it, or
                   // as many would be near some surface by chance
    out_of_range,  // its radius is outside of those asked for
    not_converged,
    other_surface,  // the points are those of another surface: a ring or strip of it, or of a kind that fits far better
    uneven,         // the points leave the surface together: it is out of round, bent or bulged
};
const char* name_of(FitIssue issue);      // "thin arc"
const char* name_of(FitVerdict verdict);  // "good"

// Standard deviations, to first order in independent errors of the inliers along the normal; infinite where the points
// do not determine it, 0 where the shape has no such number. Errors of shapes that are almost planes are larger where
// neighbouring points share theirs.
struct ShapeErrors {
    double position = 0;  // a plane along its normal, an axis across it, at the inliers' middle; the centre of sphere
                          // and torus and the cone's apex in the direction where it is largest; source units
    double angle = 0;     // turn of the normal or axis about its least certain direction, radians
    double radius = 0;    // source units
    double second = 0;    // radians (cone) or source units (torus)
};

struct ShapeFit {
    FitVerdict verdict = FitVerdict::refused;
    FitIssue issue = FitIssue::none;
    std::string message;  // a sentence for people: what, and what to do; empty when good
    Shape shape;          // source coordinates
    ShapeErrors errors;
    double condition = 0;  // condition number of the normal equations, each parameter in units of the shape's extent
    double threshold = 0;  // threshold used, source units
    double noise = 0;      // standard deviation of one inlier's distance: rms with the degrees of freedom
    double rms = 0;        // rms distance of the inliers
    std::uint64_t inliers = 0;
    std::vector<std::uint8_t> is_inlier;  // a byte per point, 1 or 0; empty without points in memory
    std::uint64_t iterations = 0;         // samples drawn
    double seconds = 0;                   // wall time

    bool has_shape() const { return verdict != FitVerdict::refused; }
};

void doubt(ShapeFit& fit, FitIssue issue, const std::string& message);  // a good fit; others keep their verdict

}  // namespace pcm
