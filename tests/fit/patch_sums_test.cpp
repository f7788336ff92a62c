// Sums over the points near a patch.
#include "pcm/fit/patch_sums.h"

#include "pcm/fit/models/shape_model.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

// Above a plane, in the middle of the k-th of the bins that divide the threshold, k + 1 points; a few beyond it. They
// are more than a block.
TEST(PatchSums, EachDistanceIsCountedInItsBin)
{
    constexpr double threshold = 0.5, width = threshold / static_cast<double>(DistanceBins::size);
    constexpr std::size_t beyond = 5;
    WorkingPoints points;
    const auto add = [&](double height) {
        const auto i = static_cast<double>(points.size());
        points.x.push_back(0.01 * i - 10);
        points.y.push_back(0.3 * i - 300);
        points.z.push_back(points.size() % 2 ? height : -height);
    };
    for (std::size_t k = 0; k < DistanceBins::size; ++k)
        for (std::size_t i = 0; i <= k; ++i) add((static_cast<double>(k) + 0.5) * width);
    const std::size_t within = points.size();
    for (std::size_t i = 0; i < beyond; ++i) add(1.5 * threshold);
    ASSERT_GT(within, 2 * patch_block);

    const ShapeModel& plane = model_of(ShapeKind::plane);
    const SurfacePatch patch = plane.patch_at(Shape(), {0, 0, 0});
    PatchBand band;
    band.threshold = threshold;
    const NoiseMixture mixture(threshold, 0.5, threshold / 4);
    ASSERT_TRUE(mixture.needs_bins());
    DistanceBins bins;
    bins.counts[3] = 100;  // what is counted is added
    const PatchSums sums = sums_of(plane, patch, points, band, &mixture, &bins);
    EXPECT_EQ(sums.inliers, within);
    for (std::size_t k = 0; k < DistanceBins::size; ++k)
        EXPECT_EQ(bins.counts[k], static_cast<double>(k + 1) + (k == 3 ? 100 : 0)) << k;
}

}  // namespace
}  // namespace pcm
