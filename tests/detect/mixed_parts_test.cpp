// Parts among points of no surface, and the points that parts keep.
#include "pcm/detect/assign_points.h"

#include "tests/place/shape_cloud.h"

#include <functional>

namespace {

using namespace pcm;
using namespace pcm::test;

class MixedParts : public testing::Test {
protected:
    // Points of a square with these heights, and the parts of level planes at some heights.
    std::vector<SurfacePart> parts(const std::function<double(Dice&)>& height_of, const std::vector<double>& heights,
                                   double threshold, std::size_t most_some = 4096)
    {
        Dice dice(3);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 20000; ++i)
            points.push_back({{dice.between(-1, 1), dice.between(-1, 1), height_of(dice)}, {}});
        const TemporaryFolder folder;
        const auto tree = build_surface_tree(folder.path(), points);
        std::vector<Hypothesis> planes(heights.size());
        for (std::size_t i = 0; i < heights.size(); ++i) {
            planes[i].shape.point = {0, 0, heights[i]};
            planes[i].box = {{-1, -1, heights[i]}, {1, 1, heights[i]}};
            planes[i].threshold = threshold;
        }
        AssignOptions options;
        options.sample = {tree->info().levels, 0.005, 0.04};
        options.normal_angle = 0.6;
        options.reach = 0.1;
        options.some_from = 0;
        options.most_some = most_some;
        options.progress = [](double) {};
        return assign_points(ChosenPoints(tree, {}), {tree->info().box}, planes, options, nullptr).parts;
    }
    static double mixed_share(const std::vector<SurfacePart>& parts)
    {
        double mixed = 0, sampled = 0;
        for (const SurfacePart& part : parts) {
            mixed += static_cast<double>(part.mixed);
            sampled += static_cast<double>(part.sampled);
        }
        EXPECT_GT(sampled, 100);
        return mixed / sampled;
    }
};

TEST_F(MixedParts, PlanesInNoiseAreAmongPointsOfNoSurface)
{
    EXPECT_GT(mixed_share(parts([](Dice& dice) { return dice.between(-0.5, 0.5); }, {0}, 0.03)), 0.5);
    EXPECT_LT(mixed_share(parts([](Dice& dice) { return dice.between(-0.001, 0.001); }, {0}, 0.03)), 0.01);
}

// Three layers within the threshold of the lowest one: most of a point's neighbours belong to the others.
TEST_F(MixedParts, PointsOfOtherSurfacesAreNotOfNone)
{
    const auto layers = [](Dice& dice) { return 0.004 * std::floor(dice.between(0, 3)) + 0.0003 * dice.normal(); };
    EXPECT_LT(mixed_share(parts(layers, {0, 0.004, 0.008}, 0.01)), 0.01);
}

TEST_F(MixedParts, PartsKeepAsManyPointsAsAskedFor)
{
    const auto flat = [](Dice& dice) { return 0.001 * dice.normal(); };
    const auto most = [&](std::size_t most_some) {
        std::size_t found = 0;
        for (const SurfacePart& part : parts(flat, {0}, 0.01, most_some)) found = std::max(found, part.some.size());
        return found;
    };
    EXPECT_GT(most(4096), 200u);
    EXPECT_LE(most(200), 200u);
    EXPECT_GT(most(200), 90u);
}

}  // namespace
