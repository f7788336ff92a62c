// Whether points near a shape are those of one surface along it. A wide threshold also holds the two faces of a plate,
// pipes side by side, the four faces of a post, or crowns of trees.
#pragma once

#include "pcm/fit/shape_fit.h"

#include <cstddef>
#include <string>
#include <vector>

namespace pcm {

// Distances of points from a shape, and how they change along it. Errors of scanners have one peak, whether neighbours
// share them or not, and turn the surface by a few degrees; distances of several surfaces within a threshold lie at
// both of its ends, and slopes of other surfaces are steep.
struct SurfaceEvidence {
    std::size_t points = 0;  // within the threshold
    // (s^2 + 1) / k of the distances, s their skewness and k their kurtosis: 1/3 for Gaussian noise, 5/9 where they are
    // spread evenly, 1 for two values (Sarle's coefficient of bimodality; Pearson 1916 for its bound).
    double two_peaks = 0;
    // Share of the squared distances that is left in means of 17 neighbours along the shape; 1/17 for independent ones.
    double bend = 0;
    // Slope of planes through the distances of these neighbours, rms without what noise alone makes of it.
    double slope = 0;

    // Errors of scanners may have any distribution where neighbours share them.
    bool has_shared_errors() const;
    bool has_two_peaks() const;
    bool is_turned() const;
    bool is_one_surface() const { return !has_two_peaks() && !is_turned(); }
    // Why it is not one surface, a sentence for people; message() adds what to do. Both are empty where it is one.
    std::string reason() const;
    std::string message() const;
};

// `points` in source coordinates; those farther than the threshold (> 0, source units) are ignored. `resolution`: grid
// step of the coordinates, source units; distances no farther apart have no peaks. Fewer than 17 points count as one
// surface. One thread; a millisecond for 4,000 points.
SurfaceEvidence surface_evidence(const Shape& shape, double threshold, double resolution,
                                 const std::vector<Vec3d>& points);

// The distance within which the points of a fit are: its threshold, or where that is wider, as it is among outliers, a
// little more than three standard deviations of its noise. Source units.
double spread_of(const ShapeFit& fit);

// The maximum distance of a place from the surface that was picked there, beyond the way to the nearest point: four
// standard deviations, and where these are far within the threshold a part of that. Source units.
double farthest_place(const ShapeFit& fit);

}  // namespace pcm
