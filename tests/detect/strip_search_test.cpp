// Pipes of which a plane finds a strip first, and strips that are flat.

#include "pcm/detect/hypotheses.h"
#include "pcm/detect/shape_search.h"
#include "pcm/fit/pipe_start.h"

#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double strip_noise = 0.0012, strip_radius = 0.11;

class StripSearches : public testing::Test {
protected:
    // A part of a pipe along x, points about 32 mm apart: a third of its radius.
    void add_pipe(double from, double to, double step = 0.032)
    {
        for (double x = 0; x < 8; x += step)
            for (double angle = from + dice_.between(0, step / strip_radius); angle < to;
                 angle += step / strip_radius) {
                const double r = strip_radius + strip_noise * dice_.normal();
                points_.push_back({{x + 0.3 * step * dice_.normal(), r * std::cos(angle), r * std::sin(angle)}, {}});
            }
    }
    void sample()
    {
        tree_ = build_surface_tree(folder_.path(), points_);
        sample_ = sample_surface(ChosenPoints(tree_, {}), tree_->info().box, {tree_->info().levels, 0.006});
        taken_.assign(sample_.size(), 0);
    }
    std::vector<FoundShape> search(bool pipes_of_strips)
    {
        ShapeSearchOptions options;
        options.kinds = {ShapeKind::plane};
        options.pipes_of_strips = pipes_of_strips;
        options.threshold = 4 * strip_noise;
        options.normal_angle = pi / 9;
        options.least_sagitta = 3 * options.threshold;
        options.least = 60;
        taken_.assign(sample_.size(), 0);
        return search_shapes(sample_, options, taken_);
    }

    Dice dice_{4};
    std::vector<SurfacePoint> points_;
    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    SurfaceSample sample_;
    std::vector<std::uint8_t> taken_;
};

TEST_F(StripSearches, FindThePipeThatAPlaneIsCutOutOf)
{
    add_pipe(0.2, 2.9);
    sample();
    const std::vector<FoundShape> pipes = search(true);
    ASSERT_EQ(pipes.size(), 1u);
    EXPECT_EQ(pipes[0].shape.kind, ShapeKind::cylinder);
    EXPECT_NEAR(pipes[0].shape.radius, strip_radius, 0.001);
    EXPECT_TRUE(pipes[0].thin);
    EXPECT_TRUE(pipes[0].of_strip);
    EXPECT_GT(pipes[0].points.size(), 97 * sample_.size() / 100);
    const std::vector<FoundShape> planes = search(false);
    ASSERT_GE(planes.size(), 2u);
    EXPECT_LT(planes[0].points.size(), 6 * sample_.size() / 10);
}

TEST_F(StripSearches, KeepStripsThatAreFlat)
{
    for (double x = 0; x < 4; x += 0.03)
        for (double y = 0; y < 0.2; y += 0.03)
            points_.push_back(
                {{x + 0.01 * dice_.normal(), y + 0.01 * dice_.normal(), strip_noise * dice_.normal()}, {}});
    sample();
    const std::vector<FoundShape> found = search(true);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].shape.kind, ShapeKind::plane);
}

// Two strips of a pipe that no edge joins.
TEST_F(StripSearches, PipesGrowPastWhatHidesPartsOfThem)
{
    add_pipe(0.2, 1.1, 0.012);
    const std::size_t first = points_.size();
    add_pipe(2.0, 2.9, 0.012);
    sample();
    ShapeGrowth growth(sample_, taken_);
    pcm::Shape pipe = parse_shape("cylinder 0 0 0 1 0 0 0.11");
    pipe.point = pipe.point - sample_.origin;
    std::vector<std::uint32_t> from;
    for (std::uint32_t i = 0; i < sample_.size() && from.size() < 200; ++i)
        if (sample_.at[i][1] + sample_.origin[1] > 0.05) from.push_back(i);
    const GrowthLimits limits{4 * strip_noise, -1, 60};
    const FoundShape side = growth.grow(pipe, from, limits);
    EXPECT_LT(side.points.size(), first + first / 20);
    EXPECT_GT(side.points.size(), first / 2);
    const FoundShape both = growth.grow_around(side, limits);
    EXPECT_GT(both.points.size(), 95 * sample_.size() / 100);
    EXPECT_NEAR(both.shape.radius, strip_radius, 0.0005);
}

TEST_F(StripSearches, ThinPipesExplainPointsWhateverTheirNormals)
{
    add_pipe(0.2, 2.9, 0.08);
    sample();
    Hypothesis pipe;
    pipe.shape = parse_shape("cylinder 0 0 0 1 0 0 0.11");
    pipe.box = {{0, -0.11, 0}, {8, 0.11, 0.11}};
    ExplainedLimits limits;
    limits.threshold = 4 * strip_noise;
    limits.reach = 0.1;
    limits.normal_angle = pi / 9;
    const auto explained = [&] {
        taken_.assign(sample_.size(), 0);
        mark_explained(sample_, {pipe}, limits, taken_);
        return static_cast<std::size_t>(std::count(taken_.begin(), taken_.end(), 1));
    };
    EXPECT_LT(explained(), 8 * sample_.size() / 10);
    pipe.thin = true;
    EXPECT_GT(explained(), 99 * sample_.size() / 100);
}

TEST(PipeStart, IsTheLineAndTheCircleOfPointsThatAreLongerThanWide)
{
    std::vector<Vec3d> points;
    for (int i = 0; i < 40; ++i)
        for (int k = 0; k < 9; ++k)
            points.push_back({0.05 * i, 1 + 0.2 * std::cos(0.2 * k), 2 + 0.2 * std::sin(0.2 * k)});
    const auto line = line_of(points, 2);
    ASSERT_TRUE(line);
    EXPECT_NEAR(std::fabs(line->axis[0]), 1, 1e-12);
    const auto pipe = cylinder_along(*line, points);
    ASSERT_TRUE(pipe);
    EXPECT_NEAR(pipe->radius, 0.2, 1e-9);
    EXPECT_NEAR(pipe->point[1], 1, 1e-9);
    EXPECT_NEAR(pipe->point[2], 2, 1e-9);
    EXPECT_NEAR(extent_along(line->axis, points), 1.95, 1e-9);
    EXPECT_FALSE(line_of(points, 20));
    EXPECT_FALSE(line_of({{0, 0, 0}, {1, 0, 0}}, 2));
}

}  // namespace
