// Elbows between pipes that a detection has found: their truth is known, and the pipes have points of the elbows.
#include "pcm/detect/elbow_search.h"

#include "pcm/piping/pipe_run.h"
#include "pcm/point_cloud.h"
#include "tests/place/shape_cloud.h"

#include <cmath>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double elbow_noise = 0.0015;
constexpr Vec3d plant{431200, 5412300, 120};

// A pipe along x that turns by `turn` counter-clockwise about `axis`, a unit vector across x.
struct BentPipe {
    Vec3d start{}, axis{0, 0, 1};
    double radius = 0, bend = 0, turn = 0, first = 1.2, last = 0.9;
    double oval = 0;  // largest difference of the elbow's radius

    double length() const { return first + bend * turn + last; }
    Vec3d left() const { return cross(axis, {1, 0, 0}); }
    Vec3d centre() const { return start + Vec3d{first, 0, 0} + bend * left(); }
    Vec3d out() const { return std::cos(turn) * Vec3d{1, 0, 0} + std::sin(turn) * left(); }
    Vec3d end_of_arc() const { return centre() + bend * (std::sin(turn) * Vec3d{1, 0, 0} - std::cos(turn) * left()); }

    // Points all around, `spacing` apart in the mean.
    void add_points(double spacing, bool has_elbow, Dice& dice, std::vector<SurfacePoint>& points) const
    {
        const auto count = static_cast<int>(length() * 2 * pi * radius / (spacing * spacing));
        for (int i = 0; i < count; ++i) {
            const double way = dice.between(0, length());
            const double angle = std::min(std::max((way - first) / bend, 0.0), turn);
            if (!has_elbow && angle > 0 && angle < turn) continue;
            const Vec3d along = std::cos(angle) * Vec3d{1, 0, 0} + std::sin(angle) * left();
            const Vec3d inwards = cross(axis, along);
            const Vec3d place = way <= first ? start + Vec3d{way, 0, 0}
                                             : centre() - bend * inwards + (way - first - bend * angle) * along;
            const double around = dice.between(0, 2 * pi);
            const Vec3d normal = std::cos(around) * inwards + std::sin(around) * axis;
            const double away = radius + (angle > 0 && angle < turn ? oval * std::cos(2 * around) : 0);
            points.push_back({place + (away + elbow_noise * dice.normal()) * normal, normal});
        }
    }

    // The straight parts with points of the elbow, as cylinders have them.
    std::vector<Primitive> pipes(double reach) const
    {
        Primitive pipe;
        pipe.points = 2000;
        pipe.fit.verdict = FitVerdict::good;
        pipe.fit.threshold = 0.006;
        pipe.fit.noise = elbow_noise;
        pipe.fit.errors = {0.0002, 0.0003, 0.0002, 0};
        pipe.name = "Cylinder 1";
        pipe.fit.shape = {ShapeKind::cylinder, start, {1, 0, 0}, radius, 0};
        pipe.bounds.from = 0;
        pipe.bounds.to = first + reach;
        Primitive other = pipe;
        other.name = "Cylinder 2";
        other.fit.shape.point = end_of_arc();
        other.fit.shape.axis = out();
        other.bounds.from = -reach;
        other.bounds.to = last;
        return {pipe, other};
    }
};

constexpr BentPipe usual{plant, {0, 0, 1}, 0.11, 0.33, pi / 2};

class ElbowSearch : public testing::Test {
protected:
    std::shared_ptr<PointCloud> cloud_of(const std::vector<SurfacePoint>& points)
    {
        build_surface_tree(folder_.path(), points);
        return PointCloud::open(folder_.path() / "surface.pct");
    }
    std::shared_ptr<PointCloud> cloud_of(const BentPipe& pipe, bool has_elbow = true)
    {
        Dice dice(3);
        std::vector<SurfacePoint> points;
        pipe.add_points(0.01, has_elbow, dice, points);
        for (int i = 0; i < 500; ++i) points.push_back({plant + 3 * dice.unit() * dice.direction(), {}});
        return cloud_of(points);
    }

    TemporaryFolder folder_;
};

TEST_F(ElbowSearch, FindsTheBendAndCutsThePipes)
{
    const BentPipe pipes[] = {usual,
                              {plant, {0, 0, -1}, 0.162, 0.486, pi / 2},
                              {plant, {0, 1, 0}, 0.057, 0.0855, pi / 2},
                              {plant, {0, 0.6, 0.8}, 0.1, 0.5, pi / 4},
                              {plant, {0, 0, 1}, 0.08, 0.2, 2 * pi / 3 - 0.05}};
    for (const BentPipe& truth : pipes) {
        const auto cloud = cloud_of(truth);
        std::vector<Primitive> list = truth.pipes(std::min(1.7 * truth.radius, 0.35 * truth.bend * truth.turn));
        const std::vector<Primitive> elbows = find_elbows(*cloud, list, {});
        ASSERT_EQ(elbows.size(), 1u) << truth.radius;
        const ShapeFit& fit = elbows[0].fit;
        EXPECT_EQ(elbows[0].name, "Elbow 1");
        EXPECT_NEAR(fit.shape.radius, truth.bend, std::max(4 * fit.errors.radius, 0.002)) << truth.radius;
        EXPECT_NEAR(fit.shape.second, truth.radius, 0.001);
        EXPECT_EQ(list[0].bounds.from, 0);
        EXPECT_EQ(list[1].bounds.to, truth.last);
        // The pipes end where the arc begins, to what the centre is known to.
        EXPECT_NEAR(list[0].bounds.to, truth.first, 0.015 * truth.bend + 0.003);
        EXPECT_NEAR(list[1].bounds.from, 0, 0.015 * truth.bend + 0.003);
        EXPECT_NEAR(elbows[0].bounds.end - elbows[0].bounds.begin, truth.turn, 0.04);
        list.push_back(elbows[0]);
        const std::vector<PipeRun> runs = pipe_runs(list);
        ASSERT_EQ(runs.size(), 1u);
        EXPECT_NEAR(runs[0].length(), truth.length(), 2 * runs[0].length_error);
        EXPECT_NEAR(runs[0].length(), truth.length(), 0.005);
    }
}

// A wide bend leaves the pipe's surface late, so the pipes have points of more than half of it.
TEST_F(ElbowSearch, PipesMayReachFarIntoWideBends)
{
    const BentPipe wide{plant, {0, 0, 1}, 0.05, 0.3, pi / 2};
    const auto cloud = cloud_of(wide);
    std::vector<Primitive> list = wide.pipes(4 * wide.radius);
    ASSERT_EQ(find_elbows(*cloud, list, {}).size(), 1u);
    EXPECT_NEAR(list[0].bounds.to, wide.first, 0.01);
    EXPECT_NEAR(list[1].bounds.from, 0, 0.01);
}

TEST_F(ElbowSearch, WithoutPointsThereIsNone)
{
    const auto cloud = cloud_of(usual, false);
    std::vector<Primitive> list = usual.pipes(0);
    EXPECT_TRUE(find_elbows(*cloud, list, {}).empty());
    EXPECT_EQ(list[0].bounds.to, usual.first);
    // The same where the selection leaves them out.
    const auto whole = cloud_of(usual);
    ElbowOptions far;
    far.limit.box = Box3d{{plant[0] - 5, plant[1] - 5, plant[2] + 50}, {plant[0] + 5, plant[1] + 5, plant[2] + 51}};
    EXPECT_TRUE(find_elbows(*whole, list, far).empty());
    EXPECT_EQ(find_elbows(*whole, list, {}).size(), 1u);
}

// A tee, whose branch ends at the main pipe, has no bend; nor have pipes of other radii.
TEST_F(ElbowSearch, NoneBetweenPipesThatDoNotBend)
{
    const auto cloud = cloud_of(usual);
    std::vector<Primitive> list = usual.pipes(0);
    list[0].fit.shape.radius = list[1].fit.shape.radius = 0.09;
    EXPECT_TRUE(find_elbows(*cloud, list, {}).empty());
    list = usual.pipes(0);
    list[1].fit.shape.radius = 0.12;
    EXPECT_TRUE(find_elbows(*cloud, list, {}).empty());
    list = usual.pipes(0);
    list[1].fit.shape.point[2] += 0.2;  // the axes miss each other
    EXPECT_TRUE(find_elbows(*cloud, list, {}).empty());
    list = usual.pipes(0);
    list[0].bounds.to += 2;  // passes the corner
    EXPECT_TRUE(find_elbows(*cloud, list, {}).empty());
}

// A valve, or whatever else is between two pipes.
TEST_F(ElbowSearch, NoneOfPointsThatLeaveItTogether)
{
    BentPipe oval = usual;
    oval.oval = 0.007;
    const auto cloud = cloud_of(oval);
    std::vector<Primitive> list = oval.pipes(0);
    EXPECT_TRUE(find_elbows(*cloud, list, {}).empty());
    EXPECT_EQ(list[0].bounds.to, oval.first);
}

TEST_F(ElbowSearch, CanBeCancelled)
{
    const auto cloud = cloud_of(usual);
    std::vector<Primitive> list = usual.pipes(0);
    ElbowOptions options;
    options.progress = [](const ProgressUpdate&) { return false; };
    EXPECT_THROW(find_elbows(*cloud, list, options), Error);
}

}  // namespace
