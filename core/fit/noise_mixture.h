// What the distances of the points near a surface are made of: Gaussian noise, and others that are anywhere.
#pragma once

#include "pcm/cloud/numbers.h"
#include "pcm/fit/block_loops.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace pcm {

// Counts of distances from 0 to a threshold.
struct DistanceBins {
    static constexpr std::size_t size = 64;
    std::array<double, size> counts{};
};

// A `share` of the points within `threshold`, known from points beyond it, has Gaussian distances of a
// learned standard deviation, cut at the threshold; the others are uniform. The weight of a point is the
// probability that it belongs to the first; towards the threshold weights fall to 0, so that no point counts suddenly.
class NoiseMixture {
public:
    // `deviation`: as a mixture of about these points learned it; 0: not known.
    explicit NoiseMixture(double threshold = infinity, double share = 1, double deviation = 0);

    // By expectation maximisation, from what is known before; nothing changes where that differs by less than can be
    // seen. Where points are few, or the threshold is within the noise, all count as if they belonged to the surface.
    // `rms` is that of weighted distances. Returns whether something changed.
    bool learn(const DistanceBins& bins, double rms);

    double threshold() const { return threshold_; }
    double deviation() const { return deviation_; }
    // Weights by distance, in a table whose steps are straight lines; the last row is for all from the threshold on.
    static constexpr std::size_t table_size = 256;
    struct Row {
        double weight = 0, grows = 0;  // at the row's distance, and per distance
        double cost = 0;               // twice the integral of weight times distance: the square, of weight 1
    };
    WeightTable table() const { return {&table_[0].weight, table_size, table_step_, 1 / table_step_}; }
    bool all_belong() const
    {
        return all_;
    }  // to the surface: there is no table, and weights only fall towards the
       // threshold, from this part of it on
    static constexpr double taper_from = 0.9;
    bool needs_bins() const;  // to learn from

private:
    bool let_all_belong(double rms);
    void make_table();

    double threshold_, share_, deviation_ = 0, table_step_ = 0;
    bool all_ = true;
    std::array<Row, table_size + 1> table_{};
};

// Standard deviation of Gaussian distances whose root mean square up to a threshold is that.
double deviation_of_cut(double rms, double threshold);
// Gaussian points per distance at a threshold, times the threshold; `points`: number within it.
double density_at_cut(double deviation, double threshold, double points);

}  // namespace pcm
