// Heights for the cells of a grid that have none, and how wrong they may be.
//
// Filling: the plane of least squares through the known cells is taken away; what is left solves Laplace's equation in
// the gaps (each cell is the mean of its neighbours), with the known cells as the border and no slope across the
// polygon's edge.
//
// Uncertainty, by cross-validation with blocks (Roberts et al. 2017, "Cross-validation strategies for data with
// temporal, spatial, hierarchical, or phylogenetic structure", Ecography 40): neighbouring cells of a gap are wrong
// together, so that neither single cells left out nor n independent errors say anything. Blocks of w by w known cells,
// w = 1, 2, 4, ..., are hidden, a quarter of the grid at a time, and filled as the gaps are; with e the error of the
// mean height of a block, E^2(w) is the mean of e^2, once for cells between known ones and once for cells that have
// known ones on one side only (extrapolation). Beyond the widest blocks that the grid holds, E grows with a power of w.
// A surface that is extrapolated may turn where the known part ends: half of the mean squared difference of heights w
// apart is added there.
// A cell in a gap as wide as w has
//
//     sigma^2 = E^2(w) (1 + D^2 / <D^2>(w)) / 2
//
// with D the difference of the heights on either side of the gap, and <D^2> that of the hidden blocks: gaps where the
// surface is rough are filled worse than others. Errors of cells nearer than w to each other count as one error,
// farther ones as independent:
//
//     variance of a sum over cells = sum_i a_i sigma_i  sum_{j within w_i of i} a_j sigma_j
//
// Where cells are narrower than the points are apart, gaps of that width are not holes: cells as near to a known one as
// nine of ten known ones are to another count as known when the width of a gap is found.
//
// What no cross-validation can see is that gaps are not placed at random: behind objects the surface has a step. If the
// differences D of the gaps exceed what the hidden blocks have, the step may be on either side of the gap, of all gaps
// for all gaps: half of the excess, times the area, is a further, common error (`step`).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace pcm {

struct FilledCells {
    std::vector<double> height;        // heights of cells with an area; the known ones are not changed
    std::vector<double> sigma;         // standard deviation of filled cells, see above; 0 for known ones
    std::vector<std::uint32_t> width;  // width of the gap around a filled cell, cells; 0 for known ones
    std::vector<std::uint8_t> outer;   // 1: a filled cell that has known ones on one side only
    std::vector<double> step;          // common error of filled cells
    bool filled = false;               // there were gaps
};

// `areas` and `height` by rows of `columns` cells; a cell without area is outside, a height that is NaN a gap. Without
// any known cell nothing is filled. `spread`: fallback for heights within a cell, where cells are too few. Time:
// some microseconds a cell; memory: about 150 bytes a cell. `check` is called several times a second by this thread,
// and ends the work by throwing. Any thread.
FilledCells fill_gaps(const std::vector<double>& height, const std::vector<double>& areas, std::size_t columns,
                      double spread = 0, const std::function<void()>& check = {});

// The standard deviation of the sum of weights times the errors of the filled cells: `weights` are areas, or parts.
double gap_uncertainty(const FilledCells& cells, const std::vector<double>& weights, std::size_t columns);

}  // namespace pcm
