// Detection of planes and pipes of which something before them hides parts.
#include "pcm/detect/detect.h"

#include "pcm/shapes/axis_frame.h"
#include "tests/detect/checked_labels.h"
#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

class DividedPlanes : public testing::Test {
protected:
    // A wall across y from x = 0 on, by its height and length, and without points where `is_hidden` (x, z).
    template <class Hidden>
    void add_wall(double length, double height, std::size_t count, const Hidden& is_hidden)
    {
        for (std::size_t i = 0; i < count; ++i) {
            const double x = dice_.between(0, length), z = dice_.between(0, height);
            if (!is_hidden(x, z)) points_.push_back({{x, 0.002 * dice_.normal(), z}, {}});
        }
    }
    void add_floor()
    {
        for (std::size_t i = 0; i < 20000; ++i)
            points_.push_back({{dice_.between(0, 8), dice_.between(-4, -0.5), 0.002 * dice_.normal()}, {}});
    }
    // Those across y.
    std::vector<Primitive> walls(DetectOptions options = {})
    {
        tree_ = build_surface_tree(folder_.path(), points_);
        const DetectReport report = detect_primitives(tree_, options);
        check_labels(*tree_, report);
        std::vector<Primitive> found;
        for (const Primitive& one : report.primitives)
            if (one.fit.shape.kind == ShapeKind::plane && std::fabs(one.fit.shape.axis[1]) > 0.9) found.push_back(one);
        return found;
    }

    Dice dice_{11};
    std::vector<SurfacePoint> points_;
    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
};

// Each of its five parts has too few points for a primitive.
TEST_F(DividedPlanes, AWebBehindPostsIsOne)
{
    add_floor();
    add_wall(8, 0.3, 2600, [](double x, double) { return std::fmod(x, 1.6) < 0.3; });
    const std::vector<Primitive> found = walls();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].fit.verdict, FitVerdict::good);
    EXPECT_GT(found[0].points, 1800u);
    EXPECT_LT(std::fabs(signed_distance(found[0].fit.shape, {4, 0, 0.15})), 4 * found[0].fit.errors.position);
}

// So has each piece of the pipe.
TEST_F(DividedPlanes, APipeBehindPostsIsOne)
{
    add_floor();
    add_wall(8, 0.5, 16000, [](double, double) { return false; });
    const Vec3d start{1, -2, 0.8}, along = normalised(Vec3d{1, 0.05, 0.02});
    const AxisFrame frame(along);
    for (int i = 0; i < 1600; ++i) {
        const double way = dice_.between(0, 5);
        if (std::fmod(way, 1.0) < 0.35) continue;
        const Vec3d out = frame.at(dice_.between(0, pi));
        points_.push_back({start + way * along + (0.03 + 0.002 * dice_.normal()) * out, {}});
    }
    tree_ = build_surface_tree(folder_.path(), points_);
    const DetectReport report = detect_primitives(tree_, {});
    check_labels(*tree_, report);
    std::vector<Primitive> pipes;
    for (const Primitive& one : report.primitives)
        if (one.fit.shape.kind == ShapeKind::cylinder) pipes.push_back(one);
    ASSERT_EQ(pipes.size(), 1u);
    EXPECT_EQ(pipes[0].fit.verdict, FitVerdict::good);
    EXPECT_GT(pipes[0].points, 800u);
    EXPECT_LT(std::fabs(pipes[0].fit.shape.radius - 0.03), 4 * pipes[0].fit.errors.radius);
    EXPECT_GT(pipes[0].bounds.to - pipes[0].bounds.from, 4.5);
}

TEST_F(DividedPlanes, AGivenStepDividesThem)
{
    add_floor();
    add_wall(8, 0.5, 16000, [](double x, double) { return x > 3.8 && x < 4.2; });
    DetectOptions options;
    EXPECT_EQ(walls(options).size(), 1u);
    options.step = 0.2;
    EXPECT_EQ(walls(options).size(), 2u);
}

}  // namespace
