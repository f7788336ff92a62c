// What the surfaces that cross a plane do to its fit where nearly all of its points lie next to them.
#include "pcm/place/crossing_surfaces.h"

#include "pcm/place/grow_shape.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double crossed_noise = 0.002, crossed_threshold = 3.3 * crossed_noise, crossed_width = 0.2;

// The web of a beam, x = 0, 3 m long and 0.2 m high, where points are as far apart as a tenth of its height.
class CrossingSurfacesTest : public testing::Test {
protected:
    CrossingSurfacesTest()
    {
        for (int i = 0; i < 800; ++i)
            add({crossed_noise * dice_.normal(), dice_.between(0, 3), dice_.between(0, crossed_width)});
    }
    void add(const Vec3d& p) { points_.push_back({p, {}}); }
    // Above it on one side, and below it on the other one if `turns`, else on the same.
    void add_flanges(bool turns)
    {
        for (int i = 0; i < 500; ++i) {
            const double side = turns ? 1 : -1;
            add({-dice_.between(0, 0.1), dice_.between(0, 3), crossed_width + crossed_noise * dice_.normal()});
            add({side * dice_.between(0, 0.1), dice_.between(0, 3), crossed_noise * dice_.normal()});
        }
    }
    GrownShape grown()
    {
        TemporaryFolder folder;
        const auto tree = build_surface_tree(folder.path(), points_);
        const PointSet seeds = set_where(tree, [&](const Vec3d& p) {
            return distance_to(web_, p) < crossed_threshold && std::fabs(p[2] - crossed_width / 2) < 0.05;
        });
        GrowShapeOptions options;
        options.threshold = crossed_threshold;
        options.step = 0.1;
        return grow_shape(web_, seeds, options);
    }
    static Shape plane()
    {
        Shape web;
        web.axis = {1, 0, 0};
        web.point = {0, 1.5, crossed_width / 2};
        return web;
    }
    double angle_of(const Shape& shape) const { return length(cross(shape.axis, web_.axis)); }

    Dice dice_{9};
    const Shape web_ = plane();
    std::vector<SurfacePoint> points_;
};

// Their points within the threshold are few, but all at its borders.
TEST_F(CrossingSurfacesTest, PCM_NOT_UNDER_THREAD(DoNotTurnASparseFace))
{
    double squares = 0, claimed = 0;
    constexpr int turns = 20;
    for (int turn = 0; turn < turns; ++turn) {
        points_.clear();
        for (int i = 0; i < 800; ++i)
            add({crossed_noise * dice_.normal(), dice_.between(0, 3), dice_.between(0, crossed_width)});
        add_flanges(true);
        const GrownShape web = grown();
        ASSERT_TRUE(web.fit.has_shape());
        const double turned = angle_of(web.fit.shape);
        EXPECT_LT(turned, 3.44 * web.fit.errors.angle);
        squares += turned * turned / turns;
        claimed += web.fit.errors.angle * web.fit.errors.angle / turns;
    }
    EXPECT_LT(std::sqrt(squares), 0.003) << "their points turn it by 0.007";
    EXPECT_LT(claimed, 6 * squares) << "the errors are no wider than two and a half times the truth";
}

TEST_F(CrossingSurfacesTest, PCM_NOT_UNDER_THREAD(DoNotShiftASparseFace))
{
    add_flanges(false);
    const GrownShape web = grown();
    ASSERT_TRUE(web.fit.has_shape());
    EXPECT_LT(distance_to(web_, web_.point + signed_distance(web.fit.shape, web_.point) * web_.axis),
              3.44 * web.fit.errors.position);
    EXPECT_LT(web.fit.errors.position, 0.25 * crossed_noise);
}

// The other face of a plate lies in one or two of the bands, and is subtracted nowhere.
TEST_F(CrossingSurfacesTest, TheOtherFaceOfAPlateIsNone)
{
    TemporaryFolder folder;
    for (int i = 0; i < 800; ++i)
        add({1.8 * crossed_threshold + crossed_noise * dice_.normal(), dice_.between(0, 3),
             dice_.between(0, crossed_width)});
    const auto tree = build_surface_tree(folder.path(), points_);
    const auto within = [&](double most) {
        return set_where(tree, [&](const Vec3d& p) { return distance_to(web_, p) <= most; });
    };
    const PointSet own = within(crossed_threshold), around = within(around_thresholds * crossed_threshold);
    ASSERT_GT(around.size(), own.size() + 700);
    EXPECT_FALSE(without_crossing(own, around, web_, crossed_threshold));
    Shape round = web_;
    round.kind = ShapeKind::sphere;
    round.radius = 5;
    round.point = {-5, 1.5, crossed_width / 2};
    EXPECT_FALSE(without_crossing(own, around, round, crossed_threshold)) << "planes alone";
}

TEST_F(CrossingSurfacesTest, DoNotDependOnThreads)
{
    TemporaryFolder folder;
    add_flanges(true);
    const auto tree = build_surface_tree(folder.path(), points_);
    const auto within = [&](double most) {
        return set_where(tree, [&](const Vec3d& p) { return distance_to(web_, p) <= most; });
    };
    const PointSet own = within(crossed_threshold), around = within(around_thresholds * crossed_threshold);
    const auto one = without_crossing(own, around, web_, crossed_threshold, 1);
    const auto three = without_crossing(own, around, web_, crossed_threshold, 3);
    ASSERT_TRUE(one && three);
    EXPECT_EQ(one->shape.point, three->shape.point);
    EXPECT_EQ(one->shape.axis, three->shape.axis);
}

}  // namespace
