// Sets of points by place, attributes and brush, against all points tested one by one.

#include "pcm/select/select_points.h"

#include "pcm/system/error.h"
#include "tests/select/cloud_of_points.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

class SelectPoints : public CloudOfPoints {};

TEST_F(SelectPoints, AreThoseThatMeetEveryCondition)
{
    make(Shape::surface, 8000);
    std::mt19937_64 random(1);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    const Vec3d m = middle();
    for (int round = 0; round < 60; ++round) {
        Selection selection;
        std::vector<Vec2d> corners;
        for (std::size_t n = 3 + random() % 6; n > 0; --n)
            corners.push_back({m[0] + between(-60, 60), m[1] + between(-40, 40)});
        if (round % 3 == 0) selection.region = Region::prism({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, corners);
        if (round % 3 == 1) selection.region = Region::sphere(m, between(1, 60));
        if (round % 2) selection.clips.push_back({Region::sphere(m, between(1, 30)), round % 4 == 1});
        if (round % 5 == 0) selection.where.push_back(parse_condition("classification<100"));
        if (round % 7 == 0) selection.box = Box3d{m - Vec3d{20, 20, 100}, m + Vec3d{50, 50, 100}};
        SelectOptions options;
        options.threads = 1 + random() % 4;
        if (round % 11 == 10) options.level = 1;
        const PointSet found = select_points(tree_, selection, options);
        const PointSet wanted = expected([&](const KnownPoint& p) {
            bool holds = (!selection.region || selection.region->contains(p.position)) &&
                         (!selection.box || selection.box->contains(p.position)) &&
                         (selection.where.empty() || p.classification < 100) &&
                         (!options.level || p.number < tree_->node(p.node).points_to_level(*options.level));
            for (const Clip& clip : selection.clips) holds = holds && clip.holds(p.position);
            return holds;
        });
        ASSERT_TRUE(found == wanted) << round << ": " << found.size() << " of " << wanted.size();
    }
    EXPECT_EQ(select_points(tree_, {}).size(), points_.size());
    Selection nowhere;
    nowhere.region = Region::sphere({0, 0, 0}, 5);
    EXPECT_TRUE(select_points(tree_, nowhere).empty());
    Selection unknown;
    unknown.where.push_back(parse_condition("colour=1"));
    EXPECT_THROW(select_points(tree_, unknown), Error);
}

// Chunks that lie inside are not read: with a damaged file, the points around the damage can be selected.
TEST_F(SelectPoints, WholeNodesAreNotRead)
{
    make(Shape::surface, 4000);
    for (const auto& entry : std::filesystem::directory_iterator(path()))
        if (entry.path().extension() == ".bpc") std::filesystem::resize_file(entry.path(), 0);
    Selection all;
    all.region = Region::sphere(middle(), 10 * size());
    EXPECT_EQ(select_points(tree_, all).size(), points_.size());
    all.where.push_back(parse_condition("classification<100"));
    EXPECT_THROW(select_points(tree_, all), Error);
}

TEST_F(SelectPoints, CancelledSelectionsThrow)
{
    make(Shape::surface, 4000);
    SelectOptions options;
    options.progress = [](const ProgressUpdate&) { return false; };
    try {
        select_points(tree_, {}, options);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
}

long double distance_to(const std::vector<Vec3d>& stroke, const Vec3d& p)
{
    long double least = HUGE_VALL;
    for (std::size_t i = 0; i < stroke.size(); ++i) {
        const Vec3d &a = stroke[i], &b = stroke[std::min(i + 1, stroke.size() - 1)];
        long double along = 0, length = 0, square = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            along += (static_cast<long double>(p[k]) - a[k]) * (static_cast<long double>(b[k]) - a[k]);
            length += (static_cast<long double>(b[k]) - a[k]) * (static_cast<long double>(b[k]) - a[k]);
        }
        const long double t = length > 0 ? std::clamp(along / length, 0.0L, 1.0L) : 0.0L;
        for (std::size_t k = 0; k < 3; ++k) {
            const long double d = p[k] - (a[k] + t * (static_cast<long double>(b[k]) - a[k]));
            square += d * d;
        }
        least = std::min(least, std::sqrt(square));
    }
    return least;
}

TEST_F(SelectPoints, ABrushTakesWhatIsNearItsStroke)
{
    make(Shape::surface, 8000);
    std::mt19937_64 random(2);
    std::size_t found_in_all = 0;
    for (int round = 0; round < 40; ++round) {
        std::vector<Vec3d> stroke{points_[random() % points_.size()].position};
        const std::size_t length = round % 4 == 0 ? 1 : 1 + random() % 60;
        while (stroke.size() < length) {
            Vec3d next = stroke.back();
            for (double& c : next) c += static_cast<double>(random() % 2001) / 200 - 5;
            stroke.push_back(next);
        }
        // Some as large as the cloud: nodes inside of them.
        const double radius = round % 5 == 0 ? 80 : static_cast<double>(random() % 1000) / 100;
        Selection limit;
        if (round % 3 == 0) limit.where.push_back(parse_condition("classification<100"));
        const PointSet found = brush_points(tree_, stroke, radius, limit);
        for (const KnownPoint& p : points_) {
            const long double from = distance_to(stroke, p.position);
            if (std::fabs(from - radius) < 1e-9) continue;
            ASSERT_EQ(found.contains(p.node, p.number),
                      from < radius && (limit.where.empty() || p.classification < 100));
        }
        found_in_all += found.size();
    }
    EXPECT_GT(found_in_all, 20000u);
    // A radius of 0 takes the point itself.
    EXPECT_GE(brush_points(tree_, {points_[5].position}, 0).size(), 1u);
    EXPECT_THROW(brush_points(tree_, {}, 1), Error);
    EXPECT_THROW(brush_points(tree_, {{NAN, 0, 0}}, 1), Error);
    EXPECT_THROW(brush_points(tree_, {{0, 0, 0}}, -1), Error);
    EXPECT_THROW(brush_points(tree_, {{0, 0, 0}}, INFINITY), Error);
}

}  // namespace
