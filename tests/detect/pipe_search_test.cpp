// Pipes that are four spacings across.

#include "pcm/detect/pipe_search.h"

#include "tests/place/shape_cloud.h"

#include <algorithm>
#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double noise = 0.0015;

class PipeSearches : public testing::Test {
protected:
    // The side of a pipe of 2 m along x that faces up, in rows a quarter of the diameter apart.
    void add_pipe(double y, double radius, double arc = 2.8)
    {
        const double step = 0.5 * radius;
        for (double x = 0; x < 2; x += step)
            for (double along = dice_.between(0, step); along < arc * radius; along += step) {
                const double angle = pi / 2 + along / radius - arc / 2, r = radius + noise * dice_.normal();
                points_.push_back(
                    {{x + 0.3 * step * dice_.normal(), y + r * std::cos(angle), r * std::sin(angle)}, {}});
            }
    }
    std::vector<FoundShape> search(std::vector<std::uint8_t>& taken)
    {
        tree_ = build_surface_tree(folder_.path(), points_);
        sample_ = sample_surface(ChosenPoints(tree_, {}), tree_->info().box, {tree_->info().levels, 0.002});
        taken.resize(sample_.size(), 0);
        PipeSearchOptions options;
        options.threshold = 0.0045;
        options.noise = noise;
        options.least = 100;
        return search_pipes(sample_, options, taken);
    }
    std::vector<FoundShape> search()
    {
        std::vector<std::uint8_t> taken;
        return search(taken);
    }

    Dice dice_{4};
    std::vector<SurfacePoint> points_;
    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    SurfaceSample sample_;
};

TEST_F(PipeSearches, FindThoseOfFourSpacingsSeenFromOneSide)
{
    const std::vector<double> radii{0.01, 0.0125, 0.015, 0.0215, 0.03};
    for (std::size_t i = 0; i < radii.size(); ++i) add_pipe(0.2 * static_cast<double>(i), radii[i]);
    std::vector<std::uint8_t> taken;
    const std::vector<FoundShape> found = search(taken);
    ASSERT_EQ(found.size(), radii.size());
    std::set<std::uint32_t> points;
    for (const FoundShape& pipe : found) {
        const auto i = static_cast<std::size_t>(std::lround((pipe.shape.point[1] + sample_.origin[1]) / 0.2));
        ASSERT_LT(i, radii.size());
        EXPECT_NEAR(pipe.shape.radius, radii[i], 0.001) << i;
        EXPECT_GT(std::fabs(pipe.shape.axis[0]), 0.9998);
        // A third of the sagitta at most.
        EXPECT_LE(pipe.threshold, 0.0045);
        EXPECT_LE(pipe.threshold, 0.34 * radii[i]);
        EXPECT_LE(pipe.rms, pipe.threshold);
        for (const std::uint32_t p : pipe.points) {
            EXPECT_TRUE(points.insert(p).second);  // no other pipe has it
            EXPECT_TRUE(taken[p]);
            EXPECT_LE(distance_to(pipe.shape, sample_.at[p]), pipe.threshold);
        }
        EXPECT_GT(static_cast<double>(pipe.points.size()), 0.75 * 2 * 2.8 / (0.25 * radii[i])) << i;
    }
}

TEST_F(PipeSearches, TakeNoPointsThatAreTaken)
{
    add_pipe(0, 0.02);
    std::vector<std::uint8_t> taken(points_.size(), 1);
    EXPECT_TRUE(search(taken).empty());
}

TEST_F(PipeSearches, FindNoneInStripsEdgesAndClutter)
{
    for (int i = 0; i < 3000; ++i) {  // a flat bar, the edge of a plate, a bush
        points_.push_back({{dice_.between(0, 2), dice_.between(0, 0.03), noise * dice_.normal()}, {}});
        const double side = dice_.between(-0.06, 0.06);
        points_.push_back({{dice_.between(0, 2), 1 + std::max(side, 0.0) + noise * dice_.normal(),
                            std::max(-side, 0.0) + noise * dice_.normal()},
                           {}});
        points_.push_back({{dice_.between(0, 0.3), 2 + dice_.between(0, 0.3), dice_.between(0, 0.3)}, {}});
    }
    for (const FoundShape& one : search()) ADD_FAILURE() << text_of(one.shape) << " of " << one.points.size();
}

TEST_F(PipeSearches, FindNoneThatAreHiddenShallowOrShort)
{
    add_pipe(0, 0.005);        // a third of its sagitta is within the noise
    add_pipe(0.4, 0.03, 1.0);  // too little of its circle
    EXPECT_TRUE(search().empty());
    // As little, but for few points of something else around its edge.
    points_.clear();
    add_pipe(0, 0.03, 2.4);
    std::size_t count = 0;
    const auto few = [&](const SurfacePoint& p) {
        return std::fabs(p.position[1]) > 0.03 * std::sin(0.6) && ++count % 20 != 0;
    };
    points_.erase(std::remove_if(points_.begin(), points_.end(), few), points_.end());
    EXPECT_TRUE(search().empty());
    points_.clear();
    add_pipe(0, 0.03);
    points_.erase(
        std::remove_if(points_.begin(), points_.end(), [](const SurfacePoint& p) { return p.position[0] > 0.08; }),
        points_.end());
    for (int i = 0; i < 9; ++i) points_.insert(points_.end(), points_.begin(), points_.begin() + 20);
    EXPECT_TRUE(search().empty());
}

}  // namespace
