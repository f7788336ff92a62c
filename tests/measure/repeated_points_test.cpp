// Clouds whose points are given several times.
#include "pcm/measure/repeated_points.h"

#include "pcm/measure/volume.h"
#include "tests/measure/measured_tree.h"

#include <cmath>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

const Vec3d place{500000, 4800000, 100};

// A file that is read twenty times measures no more than once.
TEST(RepeatedPoints, CountAsOneMeasurementInVolumes)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 20);
    std::normal_distribution<double> noise(0, 0.02);
    std::vector<Vec3d> points, repeated;
    for (int i = 0; i < 6000; ++i) {
        const double x = unit(random), y = unit(random);
        points.push_back(place + Vec3d{x, y, 0.1 * x + 0.3 * std::sin(y) + noise(random)});
    }
    for (int i = 0; i < 20; ++i) repeated.insert(repeated.end(), points.begin(), points.end());
    VolumeOptions options;
    for (const Vec3d& corner : {Vec3d{2, 2, 0}, {18, 2, 0}, {18, 18, 0}, {2, 18, 0}})
        options.polygon.push_back(place + corner);
    options.reference.height = place[2] - 5;
    const auto single = measured_tree(folder, "a", points, place), cloud = measured_tree(folder, "b", repeated, place);
    const VolumeReport once = measure_volume(*single, options), often = measure_volume(*cloud, options);
    EXPECT_NEAR(once.repeats[0], 1, 0.02);
    EXPECT_NEAR(often.repeats[0], 20, 0.5);
    EXPECT_EQ(often.points[0], 20 * once.points[0]);
    EXPECT_NEAR(often.side, once.side, 0.1 * once.side);
    EXPECT_NEAR(often.net_spread, once.net_spread, 0.1 * once.net_spread);
    EXPECT_TRUE(once.notes().empty());
    ASSERT_EQ(often.notes().size(), 1u);
    EXPECT_NE(often.notes()[0].find("20 points at each place"), std::string::npos) << often.notes()[0];
    // In cells of one side the surface is the same.
    options.side = 0.5;
    EXPECT_NEAR(measure_volume(*cloud, options).net_spread, measure_volume(*single, options).net_spread, 1e-6);
}

TEST(RepeatedPoints, ASampleHasPointsOfTheWholeStream)
{
    EvenSample sample;
    for (int i = 0; i < 100000; ++i) sample.add({1.0 * i, 0, 0});
    EXPECT_GE(sample.points().size(), 100u);
    EXPECT_LE(sample.points().size(), 256u);
    EXPECT_EQ(sample.points()[0][0], 0);
    const double step = sample.points()[1][0];
    for (std::size_t i = 0; i < sample.points().size(); ++i)
        EXPECT_EQ(sample.points()[i][0], step * static_cast<double>(i));
    EXPECT_GT(sample.points().back()[0], 100000 - 2 * step);
}

}  // namespace
