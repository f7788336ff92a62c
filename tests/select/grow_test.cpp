// Growth by connectivity against a search through all pairs of points.

#include "pcm/select/grow.h"

#include "pcm/select/flood.h"
#include "pcm/select/point_scan.h"
#include "pcm/select/select_points.h"
#include "pcm/select/surroundings_test.h"
#include "pcm/system/error.h"
#include "tests/sanitizers.h"
#include "tests/select/cloud_of_points.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <iterator>
#include <memory>
#include <random>
#include <set>
#include <thread>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

// Which points are reached, by comparing all pairs.
std::vector<bool> by_all_pairs(const std::vector<Vec3d>& points, std::vector<std::size_t> next, double distance)
{
    std::vector<bool> reached(points.size(), false);
    for (const std::size_t i : next) reached[i] = true;
    while (!next.empty()) {
        const std::size_t i = next.back();
        next.pop_back();
        for (std::size_t j = 0; j < points.size(); ++j)
            if (!reached[j] && squared_distance(points[i], points[j]) <= distance * distance) {
                reached[j] = true;
                next.push_back(j);
            }
    }
    return reached;
}

TEST(Flood, ReachesWhatStepsReach)
{
    std::mt19937_64 random(1);
    std::size_t some = 0;
    for (int round = 0; round < 300; ++round) {
        // Steps from far below the distance between points to the size of all; on a lattice, many exactly as long.
        const double spread = std::pow(10, static_cast<double>(random() % 16) - 8);
        const Vec3d centre = round % 2 ? Vec3d{4e6, 5e6, 100} : Vec3d{0, 0, 0};
        std::vector<Vec3d> points;
        Box3d box;
        for (std::size_t n = 1 + random() % 300; n > 0; --n) {
            Vec3d p = centre;
            for (double& c : p) c += spread * static_cast<double>(random() % 20);
            points.push_back(p);
            box.extend(p);
        }
        const double distance = spread * (random() % 4 ? 1 + static_cast<double>(random() % 9) / 4
                                                       : std::pow(10, static_cast<double>(random() % 14) / 2 - 4));
        const std::size_t seed = random() % points.size();
        const Vec3d outside{box.max[0] + distance / 2, points[seed][1], points[seed][2]};
        const bool from_outside = random() % 2;
        std::vector<Vec3d> all = points;
        if (from_outside) all.push_back(outside);
        const auto wanted = by_all_pairs(all, {from_outside ? points.size() : seed}, distance);
        Flood flood(points, box, distance);
        if (from_outside)
            flood.reach_from(outside);
        else
            flood.reach(seed);
        flood.run();
        std::size_t reached = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            ASSERT_EQ(flood.reached(i), wanted[i]) << "round " << round << ", distance " << distance;
            reached += wanted[i];
        }
        some += reached > 1 && reached < points.size();
    }
    EXPECT_GT(some, 30u);
}

// In one cube of any size that holds both, they would be reached together.
TEST(Flood, PointsJustFartherApartThanAStepAreNotReached)
{
    for (const double distance : {1.38, 1.39}) {
        Flood flood({{0, 0, 0}, {0.8, 0.8, 0.8}}, {{0, 0, 0}, {0.8, 0.8, 0.8}}, distance);  // sqrt(1.92) = 1.3856 apart
        flood.reach(0);
        flood.run();
        EXPECT_EQ(flood.reached(1), distance > 1.3857);
    }
    Flood flood({{0, 0, 0}, {0.8, 0.8, 0.8}}, {{0, 0, 0}, {0.8, 0.8, 0.8}}, 1.2);
    flood.reach(0);
    flood.run();
    EXPECT_FALSE(flood.reached(1));
}

// Points far apart relative to the distance: cells would be too many.
TEST(Flood, TinyStepsInAWideBox)
{
    std::vector<Vec3d> points;
    Box3d box;
    for (int cluster = 0; cluster < 5; ++cluster)
        for (int k = 0; k < 50; ++k) points.push_back({cluster * 1e9, k * 1e-6, 0});
    for (const Vec3d& p : points) box.extend(p);
    Flood flood(points, box, 1.5e-6);
    flood.reach(60);
    flood.run();
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(flood.reached(i), i >= 50 && i < 100) << i;
}

class Grow : public CloudOfPoints {
protected:
    void check(double distance, const GrowOptions& options, std::size_t seed,
               const std::function<bool(const KnownPoint&)>& allowed)
    {
        std::vector<Vec3d> positions;
        std::vector<std::size_t> known;
        std::vector<std::size_t> seeds;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            if (!allowed(points_[i])) continue;
            if (i == seed) seeds.push_back(positions.size());
            positions.push_back(points_[i].position);
            known.push_back(i);
        }
        const auto wanted = by_all_pairs(positions, seeds, distance);
        PointSet from(tree_);
        from.set(points_[seed].node, {points_[seed].number});
        const PointSet found = grow(from, distance, options);
        std::size_t count = 0;
        for (std::size_t k = 0; k < known.size(); ++k) {
            const KnownPoint& p = points_[known[k]];
            ASSERT_EQ(found.contains(p.node, p.number), wanted[k]) << "distance " << distance;
            count += wanted[k];
        }
        EXPECT_EQ(found.size(), count);
        if (count > 1 && count < known.size()) ++partly_;
        largest_ = std::max(largest_, count);
    }
    int partly_ = 0;
    std::size_t largest_ = 0;
};

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(Grow, PCM_NOT_UNDER_THREAD(ReachesWhatStepsReach))
{
    for (const Shape shape : {Shape::surface, Shape::volume, Shape::line}) {
        std::filesystem::remove_all(path());
        make(shape, tries(4000, 2000));
        const double spacing = shape == Shape::surface ? 1.5 : shape == Shape::volume ? 6 : 0.3;
        std::mt19937_64 random(2);
        for (const double factor : {0.3, 0.7, 0.9, 1.0, 1.1, 1.3, 2.0, 9.0})
            for (const unsigned threads : {1u, 3u}) {
                GrowOptions options;
                options.threads = threads;
                check(spacing * factor, options, random() % points_.size(), [](const KnownPoint&) { return true; });
            }
    }
    EXPECT_GT(partly_, 8);
}

// Units of few points: the flood passes through the same unit several times.
TEST_F(Grow, ManyUnitsGiveWhatOneGives)
{
    make(Shape::surface, 24000);
    const Vec3d m = middle();
    // A spiral wall: reached along it, not across.
    std::vector<Clip> clips;
    for (int k = 0; k < 6; ++k) {
        const double x = m[0] - 40 + 14 * k, gap = k % 2 ? -1 : 1;
        clips.push_back(
            {Region::box({{x, m[1] + (gap > 0 ? -100 : -25), -1e4}, {x + 2, m[1] + (gap > 0 ? 25 : 100), 1e4}}), true});
    }
    std::size_t seed = 0;
    for (std::size_t i = 0; i < points_.size(); ++i)
        if (points_[i].position[0] < points_[seed].position[0]) seed = i;
    const auto allowed = [&](const KnownPoint& p) {
        for (const Clip& clip : clips)
            if (!clip.holds(p.position)) return false;
        return true;
    };
    for (const double distance : {0.8, 1.2, 2.5}) {
        GrowOptions options;
        options.limit.clips = clips;
        options.memory_bytes = 1;  // the least
        options.threads = 2;
        PointSet from(tree_);
        from.set(points_[seed].node, {points_[seed].number});
        const PointSet found = grow(from, distance, options);
        options.memory_bytes = std::uint64_t(1) << 30;
        options.threads = 1;
        EXPECT_TRUE(grow(from, distance, options) == found) << distance;
        if (distance == tries(1.2, 0.0)) check(distance, options, seed, allowed);
    }
    if (tries(true, false)) EXPECT_GT(largest_, 5000u);
}

TEST_F(Grow, PassesOnlyThroughWhatTheLimitChooses)
{
    make(Shape::surface, 5000);
    GrowOptions options;
    options.limit.where.push_back(parse_condition("classification<128"));
    options.limit.box = Box3d{middle() - Vec3d{30, 90, 900}, middle() + Vec3d{30, 90, 900}};
    const auto allowed = [&](const KnownPoint& p) {
        return p.classification < 128 && options.limit.box->contains(p.position);
    };
    for (std::size_t seed = 0; seed < points_.size(); seed += tries(700, 2400)) check(2.2, options, seed, allowed);
    EXPECT_GT(largest_, 100u);
}

TEST_F(Grow, ExtremeCloudsAndDistances)
{
    make(Shape::coincident, 1000);
    const auto any = [](const KnownPoint&) { return true; };
    check(1e-9, {}, 3, any);
    EXPECT_EQ(largest_, points_.size());
    std::filesystem::remove_all(path());
    make(Shape::clusters, 2000);
    check(1, {}, 3, any);
    check(1e-6, {}, 3, any);
    check(1e9, {}, 3, any);
    PointSet none(tree_);
    EXPECT_TRUE(grow(none, 1).empty());
    for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) EXPECT_THROW(grow(none, bad), Error);
}

// Counts the units: there is a judge for each unit that is visited and for each that holds seeds. Its margin is 0.
class CountedJudges : public SurroundingsTest {
public:
    class Everywhere final : public PlaceTest {
    public:
        BoxRelation relation(const Box3d&) const override { return BoxRelation::inside; }
        bool holds(const Vec3d&) const override { return true; }
    };
    class Passing final : public Judge {
    public:
        void add(const Vec3d&) override {}
        bool passes(const Vec3d&) override { return true; }
    };
    std::unique_ptr<Judge> judge() const override
    {
        ++judges;
        return std::make_unique<Passing>();
    }
    double margin() const override { return 0; }
    const PlaceTest& counts() const override { return everywhere_; }
    mutable std::atomic<std::size_t> judges{0};

private:
    Everywhere everywhere_;
};

// Points that are looked at together share the memory, by threads.
TEST_F(Grow, UnitsAreAsSmallAsTheMemoryAsks)
{
    make(Shape::surface, 48000);  // and 12,000
    const auto judges = [&](std::uint64_t points, unsigned threads) {
        const CountedJudges counted;
        GrowOptions options;
        options.surroundings = &counted;
        options.memory_bytes = points * 192;
        options.threads = threads;
        PointSet seeds(tree_);
        seeds.set(points_[0].node, {points_[0].number});
        EXPECT_EQ(grow(seeds, 1e9, options).size(), 60000u);
        return counted.judges.load();
    };
    EXPECT_EQ(judges(70000, 1), 2u);  // one for the seed, one for the only unit
    EXPECT_GE(judges(20000, 1), 4u);
    EXPECT_GE(judges(70000, 5), 6u);
    EXPECT_LE(judges(70000, 2), 6u);
}

// A report comes a few times a second: here each unit takes longer.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(Grow, PCM_NOT_UNDER_THREAD(ReportsTheShareOfUnitsThatAreComplete))
{
    class SlowJudges final : public CountedJudges {
        std::unique_ptr<Judge> judge() const override
        {
            std::this_thread::sleep_for(std::chrono::milliseconds(130));
            return CountedJudges::judge();
        }
    };
    make(Shape::surface, 48000);
    const SlowJudges slow;
    GrowOptions options;
    options.surroundings = &slow;
    options.memory_bytes = 10000 * 192;
    options.threads = 1;
    std::vector<double> fractions;
    options.progress = [&](const ProgressUpdate& update) { return fractions.push_back(update.fraction), true; };
    PointSet seeds(tree_);
    seeds.set(points_[0].node, {points_[0].number});
    EXPECT_EQ(grow(seeds, 1e9, options).size(), 60000u);
    EXPECT_EQ(fractions.front(), 0);
    EXPECT_LT(fractions.back(), 1);
    const std::set<double> between(fractions.begin(), fractions.end());
    EXPECT_GE(between.size(), 4u);
    EXPECT_LT(*std::next(between.begin()), 0.4);
}

TEST_F(Grow, CanBeCancelled)
{
    make(Shape::surface, 4000);
    PointSet seeds = select_points(tree_, {});
    GrowOptions options;
    int calls = 0;
    options.progress = [&](const ProgressUpdate&) { return ++calls < 1; };
    try {
        grow(seeds, 1, options);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
}

}  // namespace
