// Clouds measured where a map puts them, against the same measures of clouds whose points lie at that place.
#include "pcm/measure/placed_cloud.h"

#include "pcm/measure/profile.h"
#include "pcm/measure/volume.h"
#include "pcm/system/error.h"
#include "tests/measure/measured_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

namespace {

using namespace pcm;
using namespace pcm::test;

const Vec3d origin{500000, 4800000, 100};

Affine turned(const Vec3d& axis, double radians, double scale, const Vec3d& shift)
{
    Affine map = Affine::rotation(axis, radians, origin + Vec3d{10, 10, 0}, scale);
    map.target = map.target + shift;
    return map;
}

Affine stretched(const Vec3d& by, const Vec3d& shift)
{
    Affine map = turned({1, 2, 3}, 0.4, 1, shift);
    for (Vec3d& row : map.linear)
        for (std::size_t k = 0; k < 3; ++k) row[k] *= by[k];
    return map;
}

const std::vector<std::pair<std::string, Affine>> maps{
    {"shifted", Affine::translation({3, -2, 5})},
    {"about the vertical", turned({0, 0, 1}, 0.7, 1, {4, 1, -2})},
    {"tilted", turned({1, -0.3, 0.2}, 0.5, 1, {-1, 6, 3})},
    {"upside down", turned({1, 0, 0}, pi, 1, {0, 0, 8})},
    {"scaled, from the origin", turned({0.2, 1, 3}, -1.2, 40, -1.0 * origin)},
    {"mirrored and stretched", stretched({1, -2, 0.3}, {5, 5, 5})},
};

std::vector<Vec3d> positions_of(PointCloud& cloud)
{
    std::vector<Vec3d> positions;
    auto cursor = cloud.points();
    for (PointView view; cursor.getNextData(view);)
        for (std::size_t i = 0; i < view.size(); ++i) positions.push_back(view.position(i));
    return positions;
}

class Placed : public testing::Test {
protected:
    void SetUp() override
    {
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> unit(0, 20);
        std::vector<Vec3d> points;
        for (int i = 0; i < 30000; ++i) points.push_back(origin + Vec3d{unit(random), unit(random), unit(random) / 8});
        cloud_ = measured_tree(folder_, "placed", points, origin);
        points_ = positions_of(*cloud_);
    }

    TemporaryFolder folder_;
    std::shared_ptr<PointCloud> cloud_;
    std::vector<Vec3d> points_;  // as the tree has them
};

// A box around each point's place alone, without any room.
TEST_F(Placed, RegionsOfTheCloudLoseNothingByRounding)
{
    auto with_nearly_flat = maps;
    Affine flat = turned({1, 1, 0}, 0.3, 1, {});
    flat.linear[2] = flat.linear[0] - 3.0 * flat.linear[1] + 1e-9 * flat.linear[2];
    with_nearly_flat.push_back({"nearly flat", flat});
    for (const auto& [name, map] : with_nearly_flat) {
        const PlacedCloud placed(*cloud_, map);
        const Box3d bounds = placed.bounds();
        for (std::size_t i = 0; i < points_.size(); i += 31) {
            const Vec3d p = map(points_[i]);
            ASSERT_TRUE(bounds.contains(p)) << name;
            ASSERT_TRUE(placed.own_region(Region::box({p, p})).contains(points_[i])) << name;
            Box3d beside{p, p};
            beside.min[0] = beside.max[0] = p[0] + 1e-6 * placed.most_stretch();
            ASSERT_FALSE(placed.own_region(Region::box(beside)).contains(points_[i])) << name;
        }
    }
    EXPECT_NEAR(PlacedCloud(*cloud_, maps[2].second).most_stretch(), 1, 1e-12);
    EXPECT_NEAR(PlacedCloud(*cloud_, maps[4].second).most_stretch(), 40, 1e-10);
    EXPECT_NEAR(PlacedCloud(*cloud_, maps[5].second).most_stretch(), 2, 1e-12);
    EXPECT_EQ(PlacedCloud(*cloud_, std::nullopt).most_stretch(), 1);
}

// A wide cloud and boxes about the origin: the tolerance for rounding depends on the points' coordinates, not only on
// the map and the middle of the box.
TEST(PlacedWide, BoxesThroughFarPointsLoseNoneByRounding)
{
    TemporaryFolder folder;
    std::mt19937_64 random(12);
    std::uniform_real_distribution<double> unit(-1e6, 1e6);
    std::vector<Vec3d> points;
    for (int i = 0; i < 3000; ++i) points.push_back({unit(random), unit(random), unit(random)});
    const auto cloud = measured_tree(folder, "wide", points, {});
    points = positions_of(*cloud);
    for (int turn = 0; turn < 20; ++turn) {
        const PlacedCloud placed(*cloud, Affine::rotation({1, 2, 0.1 * turn}, 0.3 + turn, {}, 1));
        const Affine map = Affine::rotation({1, 2, 0.1 * turn}, 0.3 + turn, {}, 1);
        for (const Vec3d& q : points) {
            const Vec3d p = map(q);
            Box3d box;
            box.extend(p);
            box.extend(-1.0 * p);
            ASSERT_TRUE(placed.own_region(Region::box(box)).contains(q));
        }
    }
}

TEST_F(Placed, ProfilesAreThoseOfTheMovedPoints)
{
    for (const auto& [name, map] : maps) {
        const PlacedCloud placed(*cloud_, map);
        const Vec3d low = placed.bounds().min, size = placed.bounds().max - low;
        ProfileOptions options;
        options.placement = map;
        options.width = 0.05 * size[0];
        for (const Vec2d& at : {Vec2d{0.2, 0.3}, {0.6, 0.5}, {0.7, 0.9}})
            options.line.push_back(low + Vec3d{at[0] * size[0], at[1] * size[1], 0});
        const ProfileLine line(options.line);
        for (const bool with_heights : {false, true}) {
            if (with_heights) options.lowest = low[2] + 0.4 * size[2], options.highest = low[2] + 0.5 * size[2];
            std::vector<Vec3d> expected, found;
            for (const Vec3d& q : points_) {
                const Vec3d p = map(q);
                const auto point = line.locate(p);
                if (!point || std::fabs(point->offset) > options.width / 2) continue;
                if (!with_heights || (p[2] >= *options.lowest && p[2] <= *options.highest)) expected.push_back(p);
            }
            const Outcome outcome =
                visit_profile(*cloud_, options, [&](const ProfilePoint& point, const PointView& view, std::size_t i) {
                    EXPECT_EQ(point.position, map(view.position(i)));
                    found.push_back(point.position);
                });
            std::sort(expected.begin(), expected.end());
            std::sort(found.begin(), found.end());
            ASSERT_GT(found.size(), 50u) << name;
            EXPECT_EQ(found, expected) << name;
            EXPECT_LT(outcome.points_in, 3 * points_.size() / 2)
                << name << ": of two segments, each near a part of the cloud";
        }
        // What a level leaves out is stretched too.
        ProfileOptions coarse = options;
        coarse.level = 0;
        const auto nothing = [](const ProfilePoint&, const PointView&, std::size_t) {};
        const double moved = visit_profile(*cloud_, coarse, nothing).error;
        EXPECT_NEAR(moved / (placed.most_stretch() * level_spacing(*cloud_->tree(), 0)), 1, 1e-12) << name;
        const ProfileSample sample = sample_profile(*cloud_, options, 90);
        EXPECT_LE(sample.points.size(), 90u);
        EXPECT_GT(sample.points.size(), 0u);
    }
}

// The heap that was surveyed is moved away by the inverse of a map, which brings it back.
TEST_F(Placed, VolumesAreThoseOfTheMovedSurfaces)
{
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> unit(0, 20);
    std::vector<Vec3d> before, after;
    for (int i = 0; i < 40000; ++i) {
        const double x = unit(random), y = unit(random);
        before.push_back(origin + Vec3d{x, y, 0.02 * x});
        const double u = unit(random), v = unit(random);
        const double heap = std::max(0.0, 3 - std::max(std::fabs(u - 12), std::fabs(v - 12)));
        after.push_back(origin + Vec3d{u, v, 0.02 * u + heap});
    }
    const auto old_cloud = measured_tree(folder_, "before", before, origin);
    const auto new_cloud = measured_tree(folder_, "after", after, origin);
    VolumeOptions options;
    for (const Vec2d& p : {Vec2d{2, 2}, {18, 2}, {18, 18}, {2, 18}})
        options.polygon.push_back(origin + Vec3d{p[0], p[1], 0});
    options.side = 0.5;
    options.before = old_cloud;
    const VolumeReport truth = measure_volume(*new_cloud, options);
    EXPECT_NEAR(truth.cut, 36, 1);
    int number = 0;
    for (const auto& [name, map] : maps) {
        if (name.find("scaled") != std::string::npos) continue;  // the grid of 1 mm would be 40 times as coarse there
        // The inverse, by columns of the cofactors.
        const auto away = [&m = map](const Vec3d& p) {
            const Vec3d d = p - m.target;
            Vec3d q = m.pivot;
            for (std::size_t i = 0; i < 3; ++i) {
                const Vec3d column = cross(m.linear[(i + 1) % 3], m.linear[(i + 2) % 3]);
                q = q + (d[i] / m.determinant()) * column;
            }
            return q;
        };
        std::vector<Vec3d> moved;
        for (const Vec3d& p : after) moved.push_back(away(p));
        const auto cloud = measured_tree(folder_, "moved" + std::to_string(number++), moved, origin);
        VolumeOptions placed = options;
        placed.placement = map;
        const VolumeReport report = measure_volume(*cloud, placed);
        EXPECT_NEAR(report.cut, truth.cut, 0.05) << name;
        EXPECT_NEAR(report.fill, truth.fill, 0.05) << name;
        EXPECT_NEAR(double(report.points[0]), double(truth.points[0]), 20) << name;
        // Also as the one before, and against a height; the cells' side is the usual one.
        placed.before = cloud;
        placed.placement_before = map;
        placed.placement.reset();
        EXPECT_NEAR(measure_volume(*old_cloud, placed).fill, truth.cut, 0.05) << name;
        placed.before.reset();
        placed.placement = map;
        placed.reference.height = origin[2] - 1;
        placed.side = 0;
        EXPECT_NEAR(measure_volume(*cloud, placed).cut, 36 + 256 * 1.2, 1) << name;
        placed.polygon.clear();
        EXPECT_GT(measure_volume(*cloud, placed).area, 399) << name;
    }
    // Conditions of the second cloud are its own.
    options.limits_before = Selection();
    options.limits_before->where = {parse_condition("intensity<500")};
    const VolumeReport half = measure_volume(*new_cloud, options);
    EXPECT_EQ(half.points[0], truth.points[0]);
    EXPECT_NEAR(double(half.points[1]), double(truth.points[1]) / 2, double(truth.points[1]) / 20);
    options.limits_before->where.clear();
    options.limits_before->clips = {{Region::sphere(origin + Vec3d{10, 10, 0}, 4), false}};
    EXPECT_LT(measure_volume(*new_cloud, options).points[1], truth.points[1] / 3);
}

TEST_F(Placed, MapsThatLeaveNoSpaceAreRefused)
{
    Affine flat = turned({1, 1, 0}, 0.3, 1, {});
    flat.linear[2] = flat.linear[0] - 3.0 * flat.linear[1];
    Affine none = turned({1, 1, 0}, 0.3, 1, {}), lost = none, huge = none;
    none.linear = {};
    lost.target[1] = std::numeric_limits<double>::quiet_NaN();
    huge.linear[0][0] = std::numeric_limits<double>::infinity();
    for (const Affine& wrong : {flat, none, lost, huge}) {
        ProfileOptions profile;
        profile.line = {origin, origin + Vec3d{9, 9, 0}};
        profile.placement = wrong;
        VolumeOptions volume;
        volume.placement = wrong;
        VolumeOptions second;
        second.before = cloud_;
        second.placement_before = wrong;
        EXPECT_THROW(visit_profile(*cloud_, profile, [](const ProfilePoint&, const PointView&, std::size_t) {}), Error);
        EXPECT_THROW(measure_volume(*cloud_, volume), Error);
        EXPECT_THROW(measure_volume(*cloud_, second), Error);
    }
}

}  // namespace
