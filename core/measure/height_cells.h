// The heights of points in the cells of a grid.
#pragma once

#include "pcm/measure/volume.h"

#include <cstdint>
#include <vector>

namespace pcm {

// What is known of the points of one cell. Heights are relative to a plane near them, so that few digits cancel.
struct HeightCell {
    std::uint64_t points = 0;
    double mean = 0, squares = 0;  // squares: sum of squared deviations from the mean (Welford)
    double lowest = 0, highest = 0;

    void add(double height);
    void add(const HeightCell& other);  // as if its points had been added (Chan, Golub and LeVeque)
    // As if one point of each place had been added: the same mean, from fewer heights.
    void count_places(double points_per_place);
};

// Heights of the cells and their variances; NaN for cells without points.
struct Surface2d {
    std::vector<double> height, variance;
};
// A single point has the mean variance of the cells with more.
Surface2d surface_of(const std::vector<HeightCell>& cells, CellHeight kind);

}  // namespace pcm
