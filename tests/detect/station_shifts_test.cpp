// Shifts of stations, from planes of an assignment.
#include "pcm/detect/station_shifts.h"

#include "pcm/detect/refined_shape.h"
#include "tests/place/station_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

// A floor and two walls that three stations see.
class StationShiftsTest : public testing::Test {
protected:
    void build(Says says)
    {
        Dice dice(3);
        std::vector<StationPoint> points;
        const auto put = [&](const Vec3d& p, const Vec3d& n, int station) {
            points.push_back(
                {hall + p + scan_noise * dice.normal() * n + shifts_.at(static_cast<std::size_t>(station)), station});
        };
        for (int i = 0; i < 18000; ++i) {
            const double a = dice.between(-4, 4), b = dice.between(-4, 4);
            if (i % 9 < 3) put({a, b, 0}, {0, 0, 1}, i % 3);
            if (i % 9 >= 3 && i % 9 < 6) put({a, 5, 5 + b}, {0, 1, 0}, i % 3);
            if (i % 9 >= 6) put({5, a, 5 + b}, {1, 0, 0}, i % 3);
        }
        write_stations_ply(folder_ / "hall.ply", points, says);
        BuildOptions options;
        options.overwrite = true;
        build_tree({folder_ / "hall.ply"}, folder_ / "hall.pct", options);
        tree_ = Tree::open(folder_ / "hall.pct");
        planes_.clear();
        for (std::size_t a = 0; a < 3; ++a) {
            Hypothesis plane;
            plane.shape.point = hall;
            plane.shape.axis = {};
            plane.shape.axis[a] = 1;
            if (a < 2) plane.shape.point[a] += 5;
            plane.threshold = 0.008;
            plane.box = tree_->info().bounds();
            planes_.push_back(plane);
        }
    }
    SeenPlanes seen(double noise = 0.002, unsigned threads = 1)
    {
        AssignOptions options;
        options.sample = {tree_->info().levels, 0.05, 0.4};
        options.normal_angle = 0.6;
        options.reach = 0.1;
        options.some_from = 0;
        options.least_points = 100;
        options.progress = [](double) {};
        PointLabels labels(*tree_);
        const ChosenPoints points(tree_, {});
        assigned_ = assign_points(points, {tree_->info().box}, planes_, options, &labels);
        StationShifts none;
        none.stations = std::make_shared<PointStations>(*tree_);
        return SeenPlanes(points, assigned_, planes_, labels, none, {noise, 0.05, threads, [] {}});
    }

    const std::array<Vec3d, 3> shifts_{Vec3d{0.004, -0.002, 0.003}, Vec3d{-0.001, 0.003, 0},
                                       Vec3d{-0.003, -0.001, -0.003}};
    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    std::vector<Hypothesis> planes_;
    AssignedPoints assigned_;
};

TEST_F(StationShiftsTest, AreThoseThatPlanesShow)
{
    build(Says::source_id);
    const SeenPlanes planes = seen(0.005);
    ASSERT_TRUE(planes.shifts().are_known());
    for (std::size_t a = 0; a < 3; ++a) {
        const double middle = (shifts_[0][a] + shifts_[1][a] + shifts_[2][a]) / 3;
        double mean = 0;
        for (std::uint32_t s = 0; s < 3; ++s) mean += planes.shifts().of(11 + s)[a] / 3;
        for (std::uint32_t s = 0; s < 3; ++s)
            EXPECT_NEAR(planes.shifts().of(11 + s)[a] - mean, shifts_[s][a] - middle, 0.0004) << s << " " << a;
    }
    EXPECT_EQ(planes.shifts().of(99), Vec3d{});
    for (std::size_t a = 0; a < 3; ++a) {
        Vec3d normal{};
        normal[a] = -1;
        const auto left = planes.left_along(normal);
        ASSERT_TRUE(left);
        EXPECT_LT(*left, 0.0003);
    }
    EXPECT_FALSE(planes.left_along(normalised(Vec3d{1, 1, 1}))) << "no plane shows it";
}

TEST_F(StationShiftsTest, CorrectedPointsHaveTheNoiseOfOneStation)
{
    build(Says::source_id);
    const SeenPlanes planes = seen(0.005);
    ASSERT_GE(planes.planes().size(), 3u);
    for (const SeenPlane& plane : planes.planes()) {
        EXPECT_GT(plane.points.size(), 300u);
        EXPECT_GT(plane.rms, 1.4 * scan_noise);
        const std::vector<Vec3d> there = places_of(planes.shifts().corrected(plane.points));
        EXPECT_NEAR(rms_distance(refined_shape(there, plane.shape, 0.008).value_or(plane.shape), there), scan_noise,
                    0.0002);
    }
    for (NodeId node = 0; node < tree_->nodes().size(); ++node) {
        const std::vector<Vec3d> all = planes.shifts().of_points(*tree_, node);
        const Chunk chunk = tree_->read_chunk(node, planes.shifts().stations->columns());
        ASSERT_EQ(all.size(), chunk.points);
        for (std::uint32_t i = 0; i < chunk.points; ++i)
            EXPECT_EQ(all[i], planes.shifts().of(planes.shifts().stations->at(chunk, i)));
    }
}

TEST_F(StationShiftsTest, AreUnknownWithoutQuietPlanesAndStations)
{
    build(Says::source_id);
    EXPECT_FALSE(seen(0.001).shifts().are_known());
    EXPECT_TRUE(seen(0.0016).shifts().are_known()) << "wide planes are quiet within their stations";
    build(Says::nothing);
    EXPECT_FALSE(seen(0.005).shifts().are_known());
    EXPECT_TRUE(seen(0.005).planes().empty());
    build(Says::tiles);
    EXPECT_FALSE(seen(0.005).shifts().are_known()) << "numbers of tiles are none of stations";
    EXPECT_TRUE(StationShifts{}.of_points(*tree_, 0).empty());
}

TEST_F(StationShiftsTest, DoNotDependOnThreads)
{
    build(Says::source_id);
    EXPECT_EQ(seen(0.005, 1).shifts().shifts, seen(0.005, 4).shifts().shifts);
}

}  // namespace
