#include "pcm/filter/precision.h"

#include "pcm/cache/l2_cache.h"
#include "pcm/filter/level_clock.h"
#include "pcm/update/tree_changes.h"
#include "tests/filter/oracle.h"
#include "tests/sanitizers.h"

#include <map>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

// Denser to one side, so that values differ between neighbours.
Vec3d slope(double u, double v, double w) { return {10 * u * u, 8 * v, 0.3 * std::sin(3 * u) + 0.02 * w}; }

NeighbourAttributeOptions options_of(bool radius, bool normal)
{
    NeighbourAttributeOptions options;
    options.wanted.radius = radius;
    options.wanted.normal = normal;
    options.threads = 2;
    return options;
}

class Precision : public testing::Test {
protected:
    Precision() { build_small(cloud_of(6000, 21, slope), tree_); }

    // The radii without normals, by comparing all pairs.
    std::vector<double> exact_radii(const Oracle& oracle, std::size_t k) const
    {
        std::vector<double> radii;
        for (std::size_t i = 0; i < oracle.points.size(); ++i)
            radii.push_back(std::sqrt(oracle.neighbours(i, k).squared.back()));
        return radii;
    }

    static double percentile(std::vector<double> values, double q)
    {
        std::sort(values.begin(), values.end());
        return values[static_cast<std::size_t>(std::ceil(q * double(values.size()))) - 1];
    }

    const TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "cloud.pct";
};

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(Precision, PCM_NOT_UNDER_THREAD(PointsOfTheLevelAreExactAndTheErrorOfOthersIsReported))
{
    NeighbourAttributeOptions options = options_of(true, false);
    const auto levels = Tree::open(tree_)->info().levels;
    ASSERT_GE(levels, 2);
    options.level = static_cast<std::uint16_t>(levels - 2);
    const NeighbourAttributeReport report = compute_neighbour_attributes(tree_, options);
    const Oracle oracle(tree_);
    const std::vector<double> exact = exact_radii(oracle, 16);
    std::map<std::pair<NodeId, std::uint32_t>, double> errors;
    std::vector<float> computed;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const OraclePoint& p = oracle.points[i];
        errors[{p.node, p.index}] = 100 * std::fabs(oracle.value(p, "radius") - exact[i]) / exact[i];
        if (p.level <= *options.level) EXPECT_LT((errors[{p.node, p.index}]), 1e-4);
    }
    // The others have the value of their nearest point of the level, or of one that is as near.
    for (std::size_t i = 0; i < exact.size(); i += 5) {
        if (oracle.points[i].level <= *options.level) continue;
        double least = HUGE_VAL;
        std::vector<double> values;
        for (std::size_t j = 0; j < exact.size(); ++j) {
            if (oracle.points[j].level > *options.level) continue;
            const Vec3d d = oracle.offset(oracle.points[i], oracle.points[j]);
            if (dot(d, d) < least) values.clear();
            if (dot(d, d) <= least) least = dot(d, d), values.push_back(oracle.value(oracle.points[j], "radius"));
        }
        EXPECT_TRUE(std::count(values.begin(), values.end(), oracle.value(oracle.points[i], "radius"))) << i;
    }
    ASSERT_EQ(report.level, options.level);
    ASSERT_EQ(report.points_checked, 1000u);
    ASSERT_EQ(report.errors.size(), 1u);
    std::vector<double> of_sample;
    for (const PointPlace& place : random_points(*oracle.tree, 1000, 20260101))
        of_sample.push_back(errors.at({place.node, place.index}));
    EXPECT_NEAR(report.errors[0].median, percentile(of_sample, 0.5), 1e-4);
    EXPECT_NEAR(report.errors[0].p95, percentile(of_sample, 0.95), 1e-4);
    EXPECT_EQ(report.outcome.error, report.errors[0].p95);
    std::sort(of_sample.begin(), of_sample.end());
    EXPECT_NEAR(report.errors[0].p95_low, of_sample[ranks_around_p95(1000).first], 1e-4);
    EXPECT_NEAR(report.errors[0].p95_high, of_sample[ranks_around_p95(1000).second], 1e-4);
    EXPECT_LT(report.errors[0].p95_low, report.errors[0].p95);
    EXPECT_NE(outcome_text("radii", report).find("radii at level " + std::to_string(*options.level) + ": "),
              std::string::npos);
    EXPECT_NE(outcome_text("radii", report).find(" (1000 points checked)"), std::string::npos);
    // The last level is all points.
    options.level = levels - 1;
    EXPECT_FALSE(compute_neighbour_attributes(tree_, options).level);
    EXPECT_FALSE(compute_neighbour_attributes(tree_, options_of(true, false)).level);
}

TEST_F(Precision, TextsOfOutcomes)
{
    FilterReport report;
    report.outcome.seconds = 3.14;
    EXPECT_EQ(outcome_text("radii", report), "radii: 3.1 s, exact");
    report.level = 6;
    report.points_checked = 1000;
    report.errors = {{"radii", "%", 2.41, 7.9, 7.12, 8.8}};
    EXPECT_EQ(outcome_text("radii", report),
              "radii at level 6: 3.1 s, median error 2.4 %, p95 7.9 % [7.1 to 8.8] (1000 points checked)");
    report.errors.push_back({"normals", "degrees", 0.034, 12.3, 11, 13.4});
    EXPECT_EQ(outcome_text("normals and radii", report),
              "normals and radii at level 6: 3.1 s, radii median error 2.4 %, p95 7.9 % [7.1 to 8.8]; normals "
              "median error 0.034 degrees, p95 12 degrees [11 to 13] (1000 points checked)");
}

// For numbers drawn evenly from 0..1 the interval holds 0.95 in about 95 of 100 draws, and in not many fewer.
TEST_F(Precision, TheIntervalOfThePercentileHoldsIt)
{
    EXPECT_EQ(ranks_around_p95(1000), (std::pair<std::size_t, std::size_t>{935, 963}));
    std::mt19937_64 random(9);
    for (const std::size_t count : {200u, 1000u}) {
        const auto [low, high] = ranks_around_p95(count);
        int held = 0;
        std::vector<double> values(count);
        for (int draw = 0; draw < 2000; ++draw) {
            for (double& v : values) v = static_cast<double>(random() >> 11) * 0x1p-53;
            std::sort(values.begin(), values.end());
            held += values[low] <= 0.95 && values[high] >= 0.95;
        }
        EXPECT_GE(held, 1880) << count;
        EXPECT_LE(held, 1970) << count;
    }
    EXPECT_EQ(ranks_around_p95(5), (std::pair<std::size_t, std::size_t>{3, 4}));  // 2.3 %: three at most are below
    EXPECT_EQ(ranks_around_p95(1), (std::pair<std::size_t, std::size_t>{0, 0}));
}

// A pass that is slower than predicted takes coarser levels, unit by unit, and ends.
TEST_F(Precision, APassWhoseTimeIsOverEndsAtTheCoarsestLevel)
{
    NeighbourAttributeOptions options = options_of(true, false);
    options.unit_points = 500;
    options.threads = 1;
    const auto tree = Tree::open(tree_);
    const std::size_t levels = tree->info().levels;
    for (const double seconds : {1e-9, 1e9}) {
        L2Cache cache(std::make_shared<TreeChanges>(tree_));
        LevelClock clock(std::vector<double>(levels, 1.0), levels - 1, seconds);
        NeighbourAttributeReport report;
        const auto pass = run_attribute_pass(cache, options, {}, nullptr, 1, report, &clock);
        cache.abandon();
        EXPECT_GT(pass.units, 5u);
        EXPECT_EQ(clock.units(), pass.units);
        EXPECT_EQ(clock.coarser_units(), seconds < 1 ? pass.units : 0);
        EXPECT_EQ(clock.coarsest(), seconds < 1 ? 0 : levels - 1);
        if (seconds < 1)
            EXPECT_LT(pass.outcome.points_out, 3000u);
        else
            EXPECT_EQ(pass.outcome.points_out, 6000u);
    }
}

TEST_F(Precision, RandomPointsAreOfAllPointsAlike)
{
    const auto tree = Tree::open(tree_);
    const auto places = random_points(*tree, 60000, 5);
    ASSERT_EQ(places.size(), 60000u);
    EXPECT_EQ(random_points(*tree, 60000, 5)[777].index, places[777].index);
    std::map<std::pair<NodeId, std::uint32_t>, int> counts;
    for (const PointPlace& place : places) {
        ASSERT_LT(place.index, tree->node(place.node).points);
        ++counts[{place.node, place.index}];
    }
    EXPECT_GT(counts.size(), 5990u);  // 6000 points; 10 draws a point on average
    for (const auto& [place, count] : counts) EXPECT_LT(count, 40);
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(Precision, PCM_NOT_UNDER_THREAD(AnErrorTargetChoosesTheCoarsestLevelThatKeepsIt))
{
    L2Cache cache(Tree::open(tree_));
    NeighbourAttributeOptions options = options_of(true, false);
    Watch watch(options.progress);
    std::vector<std::string> notes;
    const Oracle oracle(tree_);
    const std::vector<double> exact = exact_radii(oracle, 16);
    // The error of 95 % at each level, over all points.
    std::vector<double> p95;
    for (std::uint16_t l = 0; l < oracle.tree->info().levels; ++l) {
        std::vector<double> errors;
        for (std::size_t i = 0; i < exact.size(); i += 7) {
            std::size_t nearest = i;
            double least = HUGE_VAL;
            for (std::size_t j = 0; j < exact.size(); ++j) {
                const Vec3d d = oracle.offset(oracle.points[i], oracle.points[j]);
                if (oracle.points[j].level <= l && dot(d, d) < least) least = dot(d, d), nearest = j;
            }
            errors.push_back(100 * std::fabs(exact[nearest] - exact[i]) / exact[i]);
        }
        p95.push_back(percentile(errors, 0.95));
    }
    for (std::size_t l = 0; l + 1 < p95.size(); ++l) {
        if (l > 0 && p95[l - 1] < 1.5 * p95[l]) continue;
        options.error_target_percent = 1.2 * p95[l];
        EXPECT_EQ(choose_level(cache, options, {}, watch, notes), static_cast<std::uint16_t>(l)) << p95[l];
    }
    options.error_target_percent = 0;
    EXPECT_FALSE(choose_level(cache, options, {}, watch, notes));
    options.error_target_percent = 1e6;
    EXPECT_EQ(choose_level(cache, options, {}, watch, notes), 0);
    // The angle of a normal: 90 degrees are 157 %.
    options = options_of(false, true);
    options.error_target_percent = 158;
    EXPECT_EQ(choose_level(cache, options, {}, watch, notes), 0);
    options.error_target_percent = 1e-9;
    EXPECT_FALSE(choose_level(cache, options, {}, watch, notes));
    EXPECT_TRUE(notes.empty());
}

TEST_F(Precision, AnErrorTargetOfNormalsIsAHundredthOfARadian)
{
    NeighbourAttributeOptions options = options_of(false, true);
    options.level = static_cast<std::uint16_t>(Tree::open(tree_)->info().levels - 2);
    const double p95 = compute_neighbour_attributes(tree_, options).errors.at(0).p95;  // degrees
    const std::uint16_t level = *options.level;
    options.level.reset();
    L2Cache cache(Tree::open(tree_));
    Watch watch(options.progress);
    std::vector<std::string> notes;
    options.error_target_percent = 1.2 * p95;  // in degrees it would be kept
    EXPECT_FALSE(choose_level(cache, options, {}, watch, notes));
    options.error_target_percent = 2.3 * p95;
    const auto chosen = choose_level(cache, options, {}, watch, notes);
    ASSERT_TRUE(chosen);
    EXPECT_LE(*chosen, level);
}

TEST_F(Precision, ATimeLimitChoosesALevel)
{
    L2Cache cache(Tree::open(tree_));
    NeighbourAttributeOptions options = options_of(true, true);
    std::vector<std::string> notes;
    options.time_limit = 1000;
    Watch watch(options.progress);
    EXPECT_FALSE(choose_level(cache, options, {}, watch, notes));
    EXPECT_TRUE(notes.empty());
    options.error_target_percent = 1e6;  // level 0 is enough
    EXPECT_EQ(choose_level(cache, options, {}, watch, notes), 0);
    EXPECT_TRUE(notes.empty());
    options.error_target_percent = 0;
    options.time_limit = 1e-9;
    EXPECT_EQ(choose_level(cache, options, {}, watch, notes), 0);
    ASSERT_EQ(notes.size(), 2u);
    EXPECT_NE(notes[0].find("level 0 is predicted to take longer"), std::string::npos);
    EXPECT_NE(notes[1].find("the error target asks for level"), std::string::npos);
}

}  // namespace
