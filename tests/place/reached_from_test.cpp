// The points of a fitted shape, reached again from what is kept of how they were found.
#include "pcm/place/fit_at.h"

#include "pcm/system/error.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr Vec3d map{500123.4, 4800567.8, 100};

// Two pipes on one line with a gap between, a floor below, and single points everywhere.
class ReachedAgain : public testing::Test {
protected:
    void SetUp() override
    {
        Dice dice(21);
        std::vector<SurfacePoint> points;
        for (const double along : {0.0, 6.0}) {
            pcm::Shape pipe = pipe_;
            pipe.point = pipe.point + along * pipe.axis;
            for (int i = 0; i < 8000; ++i) points.push_back(point_on(pipe, 4, pi, 0.003, dice));
            if (along == 0) place_ = points.front().position;
        }
        pcm::Shape floor;
        floor.point = map - Vec3d{0, 0, 1};
        for (int i = 0; i < 10000; ++i) points.push_back(point_on(floor, 8, 0, 0.003, dice));
        for (int i = 0; i < 3000; ++i) points.push_back({map + 8 * dice.unit() * dice.direction(), {}});
        build_surface_tree(folder_.path(), points);
        cloud_ = PointCloud::open(folder_ / "surface.pct");
    }
    FittedPrimitive fit(const FitAtOptions& options, const std::vector<Vec3d>& not_places = {}) const
    {
        return fit_at(*cloud_, {place_}, not_places, options);
    }
    static FitAtOptions cylinder()
    {
        FitAtOptions options;
        options.fit.kind = ShapeKind::cylinder;
        return options;
    }
    void expect_again(const FittedPrimitive& found) const
    {
        ASSERT_TRUE(found.primitive.fit.has_shape());
        ASSERT_FALSE(found.points.empty());
        // Another reader of the same tree.
        const auto again = PointCloud::open(folder_ / "surface.pct");
        EXPECT_TRUE(reach_again(again->tree(), found.reached) == found.points)
            << reach_again(again->tree(), found.reached).size() << " instead of " << found.points.size();
    }

    const TemporaryFolder folder_;
    const pcm::Shape pipe_ = [] {
        pcm::Shape pipe;
        pipe.kind = ShapeKind::cylinder;
        pipe.point = map;
        pipe.axis = {1, 0, 0};
        pipe.radius = 0.5;
        return pipe;
    }();
    Vec3d place_{};
    std::shared_ptr<PointCloud> cloud_;
};

// Not under the thread sanitizer: many fits, whose threads other tests watch.
TEST_F(ReachedAgain, PCM_NOT_UNDER_THREAD(ByGrowth))
{
    const FittedPrimitive found = fit(cylinder());
    expect_again(found);
    EXPECT_LT(found.reached.seeds.size(), 20u) << "one of each group";
    const PointSet near =
        points_on_shape(cloud_->tree(), found.primitive.fit.shape, found.primitive.fit.threshold, 4, {});
    EXPECT_GT(near.size(), found.points.size() + 5000) << "the other pipe is near the same surface";
}

TEST_F(ReachedAgain, PCM_NOT_UNDER_THREAD(NearTheShapeThatGrowthFollowed))
{
    // Many points are at the threshold: the shape fitted last is slightly displaced, and has others.
    FitAtOptions options = cylinder();
    for (const double threshold : {0.002, 0.003, 0.004}) {
        options.fit.threshold = threshold;
        SCOPED_TRACE(threshold);
        expect_again(fit(options));
    }
}

TEST_F(ReachedAgain, PCM_NOT_UNDER_THREAD(OfTheNeighbourhoodAlone))
{
    FitAtOptions options = cylinder();
    options.grow = false;
    options.count = 700;
    const FittedPrimitive found = fit(options);
    expect_again(found);
    EXPECT_LE(found.points.size(), 700u);
    EXPECT_EQ(found.reached.seeds.size(), found.points.size());
}

TEST_F(ReachedAgain, PCM_NOT_UNDER_THREAD(InsideOfTheLimitAndNextToWhatWasTakenAway))
{
    FitAtOptions options = cylinder();
    options.fit.threshold = 0.01;
    const std::uint64_t all = fit(options).points.size();
    options.limit.clips.push_back({Region::sphere(place_, 1.5), false});
    const FittedPrimitive clipped = fit(options);
    expect_again(clipped);
    EXPECT_LT(clipped.points.size(), all);
    const FittedPrimitive next_to = fit(cylinder(), {place_ + Vec3d{place_[0] > map[0] + 2 ? -1.5 : 1.5, 0, 0}});
    expect_again(next_to);
    ReachedFrom without = next_to.reached;
    without.limit = {};
    EXPECT_GT(reach_again(cloud_->tree(), without).size(), next_to.points.size()) << "the place that was taken away";
}

TEST_F(ReachedAgain, PCM_NOT_UNDER_THREAD(AfterRoundsThatRaiseTheThreshold))
{
    for (const unsigned rounds : {1u, 2u, 5u}) {
        FitAtOptions options = cylinder();
        options.rounds = rounds;
        SCOPED_TRACE(rounds);
        expect_again(fit(options));
    }
}

TEST_F(ReachedAgain, PCM_NOT_UNDER_THREAD(SeedsThatAreGoneReachNothing))
{
    ReachedFrom from = fit(cylinder()).reached;
    for (Vec3d& seed : from.seeds) seed = seed + Vec3d{0.0001, 0, 0};
    EXPECT_TRUE(reach_again(cloud_->tree(), from).empty());
    from.seeds.clear();
    EXPECT_TRUE(reach_again(cloud_->tree(), from).empty());
}

TEST(FewSeeds, OneOfEachGroupNearTheShape)
{
    ReachedFrom from;
    from.shape = parse_shape("plane 0 0 0 0 0 1");
    from.threshold = 0.1;
    from.step = 1;
    // A chain with steps of 1, one seed farther away, one off the surface.
    from.seeds = {{3, 0, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {-5, 0, 0}, {1.5, 0, 0.2}, {4.25, 0, 0}};
    ReachedFrom few = from;
    keep_few_seeds(few);
    EXPECT_EQ(few.seeds, (std::vector<Vec3d>{{3, 0, 0}, {-5, 0, 0}, {4.25, 0, 0}}));
    few = from;
    few.normal_angle = 0.5;
    keep_few_seeds(few);
    EXPECT_EQ(few.seeds.size(), from.seeds.size()) << "normals may keep a seed out";
    few = from;
    few.step = 0;
    keep_few_seeds(few);
    EXPECT_EQ(few.seeds.size(), from.seeds.size());
}

}  // namespace
