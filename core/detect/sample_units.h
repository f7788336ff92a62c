// Boxes that divide a cloud, each with about as many points of a sample.
#pragma once

#include "pcm/detect/surface_sample.h"

#include <cstdint>
#include <vector>

namespace pcm {

// Numbers of points are estimated by those of the tree's nodes. The chosen points must outlive it. Any thread.
class SampleUnits {
public:
    // `share` of the points that the choice leaves, above 0: numbers of points are this share of the tree's.
    SampleUnits(const ChosenPoints& points, double share) : points_(points), share_(share) {}

    // Boxes with about this number of points of the cloud, among those that the choice touches.
    std::vector<Box3i> with_points(std::uint64_t count) const;
    // Boxes with about unit_points of the sample with this cell (source units), none with many more.
    std::vector<Box3i> with_cell(double cell) const;
    // The coarsest level that has the points of such cells; of cells of size 0 all.
    std::uint16_t level_of(double cell) const;

    static constexpr std::uint64_t unit_points = 200000;

private:
    struct LevelGrowth {
        std::uint16_t level = 0;
        double growth = 0;
    };
    LevelGrowth level_growth(double cell) const;
    double sample_points(double cell) const;
    double sample_points(const Box3i& box, double cell) const;

    const ChosenPoints& points_;
    const double share_;
};

}  // namespace pcm
