// Elbows between pipes that a detection has found: their truth is known, and the pipes have points of the elbows.
#include "pcm/detect/elbow_search.h"

#include "pcm/detect/add_elbows.h"
#include "pcm/piping/pipe_run.h"
#include "pcm/point_cloud.h"
#include "tests/detect/checked_labels.h"
#include "tests/place/shape_cloud.h"

#include <algorithm>
#include <cmath>
#include <set>

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
        const std::vector<Primitive> elbows = find_elbows(*cloud, list, {}).elbows;
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
    ASSERT_EQ(find_elbows(*cloud, list, {}).elbows.size(), 1u);
    EXPECT_NEAR(list[0].bounds.to, wide.first, 0.01);
    EXPECT_NEAR(list[1].bounds.from, 0, 0.01);
}

TEST_F(ElbowSearch, WithoutPointsThereIsNone)
{
    const auto cloud = cloud_of(usual, false);
    std::vector<Primitive> list = usual.pipes(0);
    EXPECT_TRUE(find_elbows(*cloud, list, {}).elbows.empty());
    EXPECT_EQ(list[0].bounds.to, usual.first);
    // The same where the selection leaves them out.
    const auto whole = cloud_of(usual);
    ElbowOptions far;
    far.limit.box = Box3d{{plant[0] - 5, plant[1] - 5, plant[2] + 50}, {plant[0] + 5, plant[1] + 5, plant[2] + 51}};
    EXPECT_TRUE(find_elbows(*whole, list, far).elbows.empty());
    EXPECT_EQ(find_elbows(*whole, list, {}).elbows.size(), 1u);
}

// A pipe of another radius, one whose axis misses the elbow's, one that passes the corner: the elbow joins the other
// pipe alone.
TEST_F(ElbowSearch, NoneBetweenPipesThatDoNotBend)
{
    const auto cloud = cloud_of(usual);
    const auto expect = [&](std::vector<Primitive> list, std::size_t other) {
        const std::vector<Primitive> elbows = find_elbows(*cloud, list, {}).elbows;
        ASSERT_EQ(elbows.size(), 1u) << other;
        EXPECT_NEAR(elbows[0].fit.shape.radius, usual.bend, 0.002);
        list.push_back(elbows[0]);
        const std::vector<PipeRun> runs = pipe_runs(list);
        ASSERT_EQ(runs.size(), 1u);
        EXPECT_EQ(runs[0].parts.size(), 2u);
        for (const Primitive* part : runs[0].parts) EXPECT_NE(part, &list[other]);
    };
    const std::vector<Primitive> pipes = usual.pipes(0);
    std::vector<Primitive> list = pipes;
    list[0].fit.shape.radius = list[1].fit.shape.radius = 0.09;
    EXPECT_TRUE(find_elbows(*cloud, list, {}).elbows.empty());
    list = pipes;
    list[1].fit.shape.radius = 0.12;
    expect(list, 1);
    list = pipes;
    list[1].fit.shape.point[2] += 0.2;
    expect(list, 1);
    list = pipes;
    list[0].bounds.to += 2;
    expect(list, 0);
}

// A valve, or whatever else is between two pipes.
TEST_F(ElbowSearch, NoneOfPointsThatLeaveItTogether)
{
    BentPipe oval = usual;
    oval.oval = 0.007;
    const auto cloud = cloud_of(oval);
    std::vector<Primitive> list = oval.pipes(0);
    EXPECT_TRUE(find_elbows(*cloud, list, {}).elbows.empty());
    EXPECT_EQ(list[0].bounds.to, oval.first);
}

// The pipe behind the elbow has too few points, or is hidden.
TEST_F(ElbowSearch, OnePipeSuffices)
{
    for (const BentPipe& truth : {usual, BentPipe{plant, {0, 0.6, 0.8}, 0.05, 0.15, pi / 2, 1.2, 0.1}}) {
        const auto cloud = cloud_of(truth);
        for (const std::size_t only : {0, 1}) {
            const double size = only == 0 ? truth.first : truth.last;
            if (size < 0.5) continue;
            std::vector<Primitive> list{truth.pipes(truth.radius)[only]};
            const std::vector<Primitive> elbows = find_elbows(*cloud, list, {}).elbows;
            ASSERT_EQ(elbows.size(), 1u) << truth.radius << " " << only;
            const ShapeFit& fit = elbows[0].fit;
            EXPECT_EQ(fit.verdict, FitVerdict::good);
            EXPECT_NEAR(fit.shape.radius, truth.bend, std::max(4 * fit.errors.radius, 0.002));
            EXPECT_NEAR(fit.shape.second, truth.radius, 0.001);
            EXPECT_NEAR(only == 0 ? list[0].bounds.to - truth.first : list[0].bounds.from, 0, 0.01);
            list.push_back(elbows[0]);
            const std::vector<PipeRun> runs = pipe_runs(list);
            ASSERT_EQ(runs.size(), 1u);
            EXPECT_EQ(runs[0].parts.size(), 2u);
            // The pipe behind it has points on the torus, too.
            EXPECT_NEAR(elbows[0].bounds.end - elbows[0].bounds.begin, truth.turn, 0.15);
            EXPECT_NEAR(runs[0].length(), size + truth.bend * truth.turn, 0.15 * truth.bend);
            // A doubtful one that may be a piece of an elbow is not looked behind.
            list = {truth.pipes(truth.radius)[only]};
            list[0].fit.verdict = FitVerdict::doubtful;
            (only == 0 ? list[0].bounds.from : list[0].bounds.to) =
                (only == 0 ? size : 0) + (only == 0 ? -4 : 4) * truth.radius;
            EXPECT_TRUE(find_elbows(*cloud, list, {}).elbows.empty());
        }
    }
}

TEST_F(ElbowSearch, TwoSidesOfAPipeHaveOneElbow)
{
    const auto cloud = cloud_of(usual);
    const Primitive pipe = usual.pipes(0)[0];
    std::vector<Primitive> list{pipe, pipe};
    EXPECT_EQ(find_elbows(*cloud, list, {}).elbows.size(), 1u);
}

// A pipe that continues, and one that an end cap closes.
TEST_F(ElbowSearch, NoneBehindAPipeThatEnds)
{
    BentPipe straight = usual;
    straight.turn = 1e-9;
    straight.first = straight.last = 1;
    Dice dice(6);
    std::vector<SurfacePoint> points;
    straight.add_points(0.01, true, dice, points);
    for (int i = 0; i < 400; ++i) {
        const double out = straight.radius * std::sqrt(dice.between(0, 1)), angle = dice.between(0, 2 * pi);
        points.push_back(
            {plant + Vec3d{2 + elbow_noise * dice.normal(), out * std::cos(angle), out * std::sin(angle)}, {}});
    }
    const auto cloud = cloud_of(points);
    std::vector<Primitive> list{straight.pipes(0)[0]};
    EXPECT_TRUE(find_elbows(*cloud, list, {}).elbows.empty()) << "it continues";
    list[0].bounds.to = 2;
    EXPECT_TRUE(find_elbows(*cloud, list, {}).elbows.empty());
    EXPECT_EQ(list[0].bounds.to, 2);
}

// Its threshold hides the bend of a wide pipe's elbow so well that cylinders are found along it.
constexpr BentPipe wide_pipe{plant, {0, 0, 1}, 0.25, 0.9, pi / 2};

// A cylinder along the bend, `half` to both sides of `angle`, as it was fitted to the points there.
Primitive piece_of(const BentPipe& pipe, double angle, double half)
{
    Primitive piece = pipe.pipes(0)[0];
    const Vec3d along = std::cos(angle) * Vec3d{1, 0, 0} + std::sin(angle) * pipe.left();
    const Vec3d outwards = std::sin(angle) * Vec3d{1, 0, 0} - std::cos(angle) * pipe.left();
    // The middle of its centre line's chord, and a third of the way to the arc.
    piece.fit.shape.point = pipe.centre() + pipe.bend * (1 - half * half / 3) * outwards;
    piece.fit.shape.axis = along;
    piece.fit.verdict = FitVerdict::doubtful;
    piece.bounds.from = -pipe.bend * half;
    piece.bounds.to = pipe.bend * half;
    return piece;
}

using Pieces = std::vector<bool>;

TEST_F(ElbowSearch, CylindersAlongABendArePiecesOfIt)
{
    const auto cloud = cloud_of(wide_pipe);
    const std::vector<Primitive> pipes = wide_pipe.pipes(0.3);
    const Primitive first = piece_of(wide_pipe, 0.5, 0.2), second = piece_of(wide_pipe, 1.0, 0.2);
    Primitive doubted = pipes[1];  // as short as pieces are
    doubted.fit.verdict = FitVerdict::doubtful;
    const auto expect = [&](std::vector<Primitive> list, const Pieces& pieces) {
        const ElbowReport found = find_elbows(*cloud, list, {});
        ASSERT_EQ(found.elbows.size(), 1u);
        EXPECT_EQ(found.is_piece, pieces);
        EXPECT_EQ(found.elbows[0].fit.verdict, FitVerdict::good);
        EXPECT_NEAR(found.elbows[0].fit.shape.radius, wide_pipe.bend, 0.005);
        EXPECT_NEAR(found.elbows[0].fit.shape.second, wide_pipe.radius, 0.001);
        // The pipes end where the bend begins, whatever else is along it.
        for (std::size_t i = 0; i < list.size(); ++i)
            if (!pieces[i]) EXPECT_NEAR(i == 0 ? list[i].bounds.to - wide_pipe.first : list[i].bounds.from, 0, 0.02);
    };
    expect({pipes[0], pipes[1], first, second}, {false, false, true, true});
    expect({pipes[0], doubted, first}, {false, false, true});
    expect({pipes[0], doubted, first, second}, {false, false, true, true});
    expect({pipes[0], first, second}, {false, true, true});
    expect({first, second}, {true, true});
    Primitive good = second;
    good.fit.verdict = FitVerdict::good;
    expect({pipes[0], first, good}, {false, true, true});
    // What is longer is a pipe.
    Primitive lengthened = second;
    lengthened.bounds.to = 6 * wide_pipe.radius;
    std::vector<Primitive> list{pipes[0], pipes[1], lengthened};
    EXPECT_EQ(find_elbows(*cloud, list, {}).is_piece, Pieces({false, false, false}));
}

// What a detection finds of the same pipe, and of a floor.
TEST_F(ElbowSearch, AnElbowHasThePointsOfItsPieces)
{
    Dice dice(5);
    std::vector<SurfacePoint> points;
    wide_pipe.add_points(0.012, true, dice, points);
    for (int i = 0; i < 20000; ++i)
        points.push_back(
            {plant + Vec3d{dice.between(-1, 4), dice.between(-2, 3), elbow_noise * dice.normal() - 1}, {}});
    // Points where its circle would continue.
    constexpr double beyond = 3.5;
    for (int i = 0; i < 200; ++i) {
        const double angle = beyond + dice.between(-0.1, 0.1), around = dice.between(0, 2 * pi);
        const Vec3d outwards = std::sin(angle) * Vec3d{1, 0, 0} - std::cos(angle) * wide_pipe.left();
        points.push_back({wide_pipe.centre() + (wide_pipe.bend + wide_pipe.radius * std::cos(around)) * outwards +
                              wide_pipe.radius * std::sin(around) * wide_pipe.axis,
                          {}});
    }
    const auto cloud = cloud_of(points);
    DetectReport report = detect_primitives(cloud->tree(), {});
    const std::uint64_t before = report.outcome.points_out;
    const std::size_t most = report.primitives.size();
    ASSERT_GT(most, 3u) << "no piece of the elbow was found, and nothing is tested";
    ASSERT_EQ(add_elbows(*cloud, {}, report), 1u);
    check_labels(*cloud->tree(), report);
    ASSERT_EQ(report.primitives.size(), 4u);
    ASSERT_EQ(report.agreement.size(), 4u);
    const auto of_kind = [&](ShapeKind kind) {
        return std::count_if(report.primitives.begin(), report.primitives.end(),
                             [&](const Primitive& one) { return one.fit.shape.kind == kind; });
    };
    EXPECT_EQ(of_kind(ShapeKind::cylinder), 2);
    EXPECT_EQ(of_kind(ShapeKind::plane), 1);
    EXPECT_GE(report.outcome.points_out, before);
    std::set<std::string> names;
    for (const Primitive& one : report.primitives) names.insert(one.name);
    EXPECT_EQ(names, (std::set<std::string>{"Plane 1", "Cylinder 1", "Cylinder 2", "Elbow 1"}));
    const auto elbow = std::find_if(report.primitives.begin(), report.primitives.end(),
                                    [](const Primitive& one) { return one.fit.shape.kind == ShapeKind::torus; });
    // Its arc's area, but for what the pipes' thresholds reach of it.
    const double whole = 2 * pi * wide_pipe.radius * wide_pipe.bend * wide_pipe.turn / (0.012 * 0.012);
    EXPECT_GT(static_cast<double>(elbow->points), 0.6 * whole);
    EXPECT_LT(static_cast<double>(elbow->points), 1.02 * whole);
    ASSERT_EQ(pipe_runs(report.primitives).size(), 1u);
    for (const PlacedPoint& p : all_points(*cloud->tree())) {
        if (report.labels->get(p.node)[p.number] != elbow->label) continue;
        const Vec3d d = p.position - wide_pipe.centre();
        EXPECT_GT(dot(d, Vec3d{1, 0, 0}) - dot(d, wide_pipe.left()), 0) << "the point is not on its arc";
    }
    // Points that the selection leaves out have no label.
    DetectOptions half;
    half.limit.box = Box3d{plant + Vec3d{-1, -2, -2}, plant + Vec3d{4, 3, 0}};
    DetectReport of_half = detect_primitives(cloud->tree(), half);
    ElbowOptions elbows;
    elbows.limit = half.limit;
    add_elbows(*cloud, elbows, of_half);
    check_labels(*cloud->tree(), of_half);
    for (const PlacedPoint& p : all_points(*cloud->tree()))
        if (p.position[2] > plant[2] + 1e-6) ASSERT_EQ(of_half.labels->get(p.node)[p.number], 0u);
}

TEST_F(ElbowSearch, WithoutElbowsAReportStays)
{
    const auto cloud = cloud_of(usual, false);
    DetectReport report = detect_primitives(cloud->tree(), {});
    const auto labels = report.labels;
    const std::size_t count = report.primitives.size();
    EXPECT_EQ(add_elbows(*cloud, {}, report), 0u);
    EXPECT_EQ(report.primitives.size(), count);
    EXPECT_EQ(report.labels, labels);
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
