// Rough floors that end, and ground that continues: which pieces a wider shape replaces.
#include "pcm/detect/wider_shapes.h"

#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double threshold = 0.01;

class WiderShapes : public testing::Test {
protected:
    // The points of `height` within a square of that side about a place, every 2 cm with 1 mm of noise.
    template <class Height>
    void add_square(const Vec3d& centre, double side, const Height& height)
    {
        std::normal_distribution<double> noise(0, 0.001);
        for (double x = -side / 2; x <= side / 2; x += 0.02)
            for (double y = -side / 2; y <= side / 2; y += 0.02)
                points_.push_back({centre + Vec3d{x, y, height(x, y) + noise(random_)}, {}});
    }
    // A level plane at a height, with those of the points around `centre` that are within its threshold.
    Hypothesis level_plane(const Vec3d& centre, double side, double height) const
    {
        Hypothesis one;
        one.shape.point = centre + Vec3d{0, 0, height};
        one.threshold = threshold;
        one.reach = 0.08;
        std::vector<Vec3d> near;
        for (const SurfacePoint& p : points_) {
            const Vec3d d = p.position - centre;
            if (std::fabs(d[0]) > side / 2 || std::fabs(d[1]) > side / 2 || std::fabs(d[2] - height) > threshold)
                continue;
            near.push_back(p.position);
            one.box.extend(p.position);
        }
        for (std::size_t i = 0; i < hypothesis_points; ++i)
            one.some.push_back(near[i * near.size() / hypothesis_points]);
        one.area = 0.0004 * double(near.size());
        one.rms = 0.005;
        return one;
    }
    std::vector<Hypothesis> widened(std::vector<Hypothesis> all, unsigned threads = 2)
    {
        const auto tree = build_surface_tree(folder_.path(), points_);
        WidenOptions options;
        for (WidenSample* sample : {&options.fine, &options.coarse}) {
            const double cell = sample == &options.fine ? 0.04 : 0.12;
            sample->assign.sample = {tree->info().levels, cell, 8 * cell};
            sample->assign.normal_angle = 0.6;
            sample->assign.reach = 0.4;
            sample->assign.least_points = 500;
            sample->assign.threads = threads;
            sample->assign.progress = [](double) {};
            sample->units = {tree->info().box};
        }
        options.merge.gap = 0.4;
        options.merge.normal_angle = 0.6;
        return with_wider_shapes(ChosenPoints(tree, {}), std::move(all), options);
    }

    TemporaryFolder folder_;
    std::mt19937_64 random_{5};
    std::vector<SurfacePoint> points_;
};

const Vec3d floor_place{0, 0, 0}, hill_place{20, 0, 0}, desk_place{0, 10, 0};

// The floor's waves are twice as high as the threshold: it comes as crests and troughs. The hill falls by 3 m.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(WiderShapes, PCM_NOT_UNDER_THREAD(ReplaceThePiecesOfASurfaceThatEndsAndNoOthers))
{
    add_square(floor_place, 4, [](double x, double) { return 0.018 * std::sin(2 * pi * x / 1.3); });
    add_square(hill_place, 6, [](double x, double y) { return -(x * x + y * y) / 6; });
    add_square(desk_place, 2, [](double, double) { return 0.7; });
    const std::vector<Hypothesis> given{level_plane(floor_place, 4, 0.012), level_plane(floor_place, 4, -0.012),
                                        level_plane(hill_place, 6, 0), level_plane(desk_place, 2, 0.7)};
    const std::vector<Hypothesis> found = widened(given);
    ASSERT_EQ(found.size(), 3u);
    const auto near = [&](const Vec3d& place) -> const Hypothesis& {
        return *std::min_element(found.begin(), found.end(), [&](const Hypothesis& a, const Hypothesis& b) {
            return length(a.box.centre() - place) < length(b.box.centre() - place);
        });
    };
    const Hypothesis &floor = near(floor_place), &hill = near(hill_place), &desk = near(desk_place + Vec3d{0, 0, 0.7});
    EXPECT_TRUE(floor.whole);
    EXPECT_GE(floor.threshold, 2 * threshold);
    EXPECT_LE(floor.threshold, 8 * threshold);
    EXPECT_NEAR(std::fabs(floor.shape.axis[2]), 1, 1e-4);
    EXPECT_NEAR(distance_to(floor.shape, floor_place), 0, 0.003);
    EXPECT_GT(floor.box.extent(0), 3.9);
    EXPECT_GT(floor.box.extent(1), 3.9);
    EXPECT_GT(floor.area, 8);
    EXPECT_NEAR(floor.rms, 0.018 / std::sqrt(2.0), 0.003);
    for (const Hypothesis& stays : {hill, desk}) {
        EXPECT_EQ(stays.threshold, threshold);
        EXPECT_FALSE(stays.whole);
    }
    EXPECT_EQ(hill.some, given[2].some);
    EXPECT_EQ(desk.some, given[3].some);
    const std::vector<Hypothesis> by_one = widened(given, 1);
    ASSERT_EQ(by_one.size(), found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(by_one[i].shape.point, found[i].shape.point) << "whatever the threads";
        EXPECT_EQ(by_one[i].some, found[i].some);
    }
}

// A layer that is whole at the threshold becomes part of the floor that the others are pieces of; one that is turned
// away or is far away does not.
TEST_F(WiderShapes, TakeInLayersThatAreEven)
{
    add_square(floor_place, 4, [](double x, double y) {
        return std::fabs(x) < 0.65 && std::fabs(y) < 0.65 ? 0.0 : 0.018 * std::sin(2 * pi * x / 1.3);
    });
    add_square(desk_place, 2, [](double, double) { return 0.7; });
    std::vector<Hypothesis> given{level_plane(floor_place, 4, 0.012), level_plane(floor_place, 4, -0.012),
                                  level_plane(floor_place, 1.3, 0), level_plane(desk_place, 2, 0.7)};
    const std::vector<Hypothesis> found = widened(given);
    ASSERT_EQ(found.size(), 2u);
    const Hypothesis& floor = found[0].box.centre()[1] < 5 ? found[0] : found[1];
    EXPECT_TRUE(floor.whole);
    EXPECT_GT(floor.threshold, threshold);
    EXPECT_GT(floor.box.extent(0), 3.9);
}

TEST_F(WiderShapes, WithoutPiecesAllStaysAsItWas)
{
    add_square(desk_place, 2, [](double, double) { return 0.7; });
    const std::vector<Hypothesis> given{level_plane(desk_place, 2, 0.7)};
    const std::vector<Hypothesis> found = widened(given);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].threshold, threshold);
    EXPECT_EQ(found[0].some, given[0].some);
    EXPECT_TRUE(widened({}).empty());
}

}  // namespace
