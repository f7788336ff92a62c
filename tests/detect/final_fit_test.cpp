// What is made of the parts that points were assigned to: which are primitives, and which are left out as pieces.

#include "pcm/detect/final_fit.h"

#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

// Three floors side by side, a part each, numbered by their labels.
class FinalFitTest : public testing::Test {
protected:
    static constexpr std::uint64_t points_of[] = {700, 900, 1300};

    FinalFitTest()
    {
        assigned_.parts.resize(3);
        for (std::uint32_t floor = 0; floor < 3; ++floor) assigned_.numbers.push_back({floor, floor});
        build([](std::size_t, double, double, Dice&) { return 0; });
    }
    // `height` of a floor's point at a place in the unit square.
    void build(const std::function<double(std::size_t, double, double, Dice&)>& height)
    {
        Dice dice(5);
        std::vector<SurfacePoint> points;
        for (std::size_t floor = 0; floor < 3; ++floor)
            for (std::uint64_t i = 0; i < points_of[floor]; ++i) {
                const double x = dice.between(0, 1), y = dice.between(0, 1);
                points.push_back({{2 * static_cast<double>(floor) + x, y, height(floor, x, y, dice)}, {}});
            }
        tree_ = build_surface_tree(folder_.path(), points);
    }
    // As a part of a surface that bends away from the plane.
    static void bend(SurfacePart& part, double threshold)
    {
        part.sampled = 10000;
        part.edge = 400;
        part.continued = 200;
        part.squares = 9600 * 0.25 * threshold * threshold;
        part.smooth_squares = 0.8 * part.squares;
        ASSERT_TRUE(is_piece(part, threshold));
    }
    FinalFit fit(bool keep_pieces, double noise = 0, bool only_good = false)
    {
        PointLabels labels(*tree_);
        for (SurfacePart& part : assigned_.parts) part.points = 0;
        for (const PlacedPoint& p : all_points(*tree_)) {
            const auto floor = static_cast<std::uint32_t>(p.position[0] / 2);
            const std::uint32_t label = (floor + 1) | (is_inside_(p.position) ? interior_label : 0);
            labels.set(p.node, {p.number}, &label);
            assigned_.parts[floor].box.extend(p.position);
            ++assigned_.parts[floor].points;
        }
        FinalFitOptions options;
        options.least_points = 100;
        options.keep_pieces = keep_pieces;
        options.is_automatic = noise > 0;
        options.noise = noise;
        options.only_good = only_good;
        options.cell = cell_;
        options.progress = [](double) {};
        return fit_parts(ChosenPoints(tree_, {}), {hypothesis_}, assigned_, labels, options);
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    AssignedPoints assigned_;
    std::function<bool(const Vec3d&)> is_inside_ = [](const Vec3d&) { return true; };
    double cell_ = 0.005;
    Hypothesis hypothesis_ = [] {
        Hypothesis floor;
        floor.box = {{-1, -1, -1}, {6, 2, 1}};
        floor.threshold = 0.01;
        return floor;
    }();
};

TEST_F(FinalFitTest, PiecesAreCountedWithTheirPoints)
{
    bend(assigned_.parts[0], hypothesis_.threshold);
    bend(assigned_.parts[2], hypothesis_.threshold);
    for (const bool keep : {false, true}) {
        const FinalFit result = fit(keep);
        EXPECT_EQ(result.primitives.size(), keep ? 3u : 1u);
        EXPECT_EQ(result.pieces, 2u);
        EXPECT_EQ(result.piece_points, points_of[0] + points_of[2]);
    }
    // It was tried whether they are pieces of something bent: they are not.
    hypothesis_.whole = true;
    const FinalFit whole = fit(false);
    EXPECT_EQ(whole.primitives.size(), 3u);
    EXPECT_EQ(whole.pieces, 0u);
    EXPECT_EQ(whole.piece_points, 0u);
}

// A floor with the scanner's noise, the two faces of a plate within the threshold, and a floor that is bent. In other
// orders, too, since a floor's number of points decides its place in the list.
TEST_F(FinalFitTest, PlatesAndBentFloorsAreDoubted)
{
    const auto flat = [](double, double, Dice& dice) { return 0.001 * dice.normal(); };
    const auto plate = [](double, double, Dice& dice) {
        return (dice.unit() < 0.5 ? -1 : 1) * 0.004 + 0.001 * dice.normal();
    };
    const auto bent = [](double x, double, Dice& dice) {
        return 0.016 * (x - 0.5) * (x - 0.5) + 0.001 * dice.normal();
    };
    for (std::size_t turn = 0; turn < 3; ++turn) {
        build([&](std::size_t floor, double x, double y, Dice& dice) {
            const std::size_t kind = (floor + turn) % 3;
            return kind == 0 ? flat(x, y, dice) : kind == 1 ? plate(x, y, dice) : bent(x, y, dice);
        });
        const FinalFit result = fit(false, 0.001), given = fit(false);
        ASSERT_EQ(result.primitives.size(), 3u);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t kind = (2 - i + turn) % 3;  // most points first
            const ShapeFit& one = result.primitives[i].fit;
            const FitIssue issues[] = {FitIssue::none, FitIssue::other_surface, FitIssue::uneven};
            EXPECT_EQ(one.issue, issues[kind]) << "floor of kind " << kind << ": " << one.message;
            EXPECT_EQ(one.verdict, kind == 0 ? FitVerdict::good : FitVerdict::doubtful);
            EXPECT_EQ(given.primitives[i].fit.verdict, FitVerdict::good)
                << "a threshold that is given says what is one";
            if (kind == 1) {
                EXPECT_NE(one.message.find("lower threshold"), std::string::npos);
            }
            // 0.016 (x - 1/2)^2 leaves its mean by 0.016 / sqrt(180)
            if (kind == 2) {
                EXPECT_NEAR(std::stod(one.message.substr(one.message.find("by ") + 3)), 0.016 / std::sqrt(180),
                            0.00015);
            }
        }
    }
}

// A plane with the cloud's noise, a plate within the threshold, and a strip of more noise, as of pipes: the last two
// are searched again where they are narrow.
TEST_F(FinalFitTest, NarrowPlanesOfSeveralSurfacesAreContested)
{
    build([](std::size_t floor, double, double, Dice& dice) {
        if (floor == 1) return (dice.unit() < 0.5 ? -1 : 1) * 0.004 + 0.001 * dice.normal();
        return (floor == 0 ? 0.002 : 0.003) * dice.normal();
    });
    const auto contested = [&](std::uint64_t sampled, double noise) {
        for (SurfacePart& part : assigned_.parts) part.sampled = sampled;
        return fit(false, noise).contested;  // most points first: the last floor, the plate, the first floor
    };
    cell_ = 0.01;
    EXPECT_EQ(contested(10000, 0.0023), (std::vector<bool>{true, true, false}));
    EXPECT_EQ(contested(10000, 0.0028), (std::vector<bool>{false, true, false})) << "noise is not above the cloud's";
    EXPECT_EQ(contested(20000, 0.0023), (std::vector<bool>{false, false, false})) << "141 thresholds wide";
    hypothesis_.whole = true;
    EXPECT_EQ(contested(10000, 0.0023), (std::vector<bool>{false, false, false})) << "a rough surface that ends";
}

// The border along one side of each floor is 5 mm higher, as where another surface meets it, and turns the floor.
TEST_F(FinalFitTest, ErrorsContainWhatTheEdgesMoveAShapeBy)
{
    build([](std::size_t, double x, double, Dice& dice) { return (x > 0.7 ? 0.005 : 0) + 0.0005 * dice.normal(); });
    const auto inside_to = [&](double end) {
        is_inside_ = [end](const Vec3d& p) { return std::fmod(p[0], 2) < end && std::fmod(p[0], 2) > 0.3; };
        return fit(false).primitives[0].fit;  // floor 2
    };
    const ShapeFit few = inside_to(0.6), none = inside_to(0.3);
    const auto angle = [](const ShapeFit& one) { return length(cross(one.shape.axis, {0, 0, 1})); };
    EXPECT_GT(angle(few), 0.003) << "a third of the points inside is too few to be used alone";
    EXPECT_LE(angle(few), 2 * few.errors.angle);
    EXPECT_GT(angle(none), 5 * none.errors.angle) << "nothing shows it without points inside";
    EXPECT_EQ(few.verdict, FitVerdict::good);
}

// Wide relative to the threshold, as floors and ceilings of rooms that bend by more than it.
TEST_F(FinalFitTest, WideFlatPiecesAreKeptAsDoubtful)
{
    bend(assigned_.parts[0], hypothesis_.threshold);
    // 10,000 points of the sample, a cell each, over the diagonal of a unit square.
    cell_ = 0.008;  // 45 thresholds wide
    EXPECT_EQ(fit(false).pieces, 1u);
    cell_ = 0.009;  // 57
    const FinalFit kept = fit(false, 0.0015);
    EXPECT_EQ(kept.pieces, 0u);
    ASSERT_EQ(kept.primitives.size(), 3u);
    EXPECT_EQ(kept.primitives[2].fit.verdict, FitVerdict::doubtful);  // the one of fewest points
    EXPECT_EQ(kept.primitives[0].fit.verdict, FitVerdict::good);
}

TEST_F(FinalFitTest, WhatNeighboursLeaveTogetherIsDoubted)
{
    build([](std::size_t, double, double, Dice& dice) { return 0.001 * dice.normal(); });
    SurfacePart& part = assigned_.parts[1];
    const auto verdict = [&](double bend, std::uint64_t continued, double noise) {
        part.sampled = 1000;
        part.edge = 100;
        part.continued = continued;
        part.squares = 900 * 0.001 * 0.001;
        part.smooth_squares = bend * bend * part.squares;
        const FinalFit result = fit(false, noise);
        EXPECT_EQ(result.primitives.size(), 3u);
        return result.primitives[1].fit.verdict;
    };
    EXPECT_EQ(verdict(0.3, 20, 0.002), FitVerdict::good);
    EXPECT_EQ(verdict(0.55, 4, 0.002), FitVerdict::good);
    EXPECT_EQ(verdict(0.55, 6, 0.002), FitVerdict::doubtful);
    EXPECT_EQ(verdict(0.65, 0, 0.002), FitVerdict::good);
    EXPECT_EQ(verdict(0.65, 0, 0.0005), FitVerdict::doubtful);
}

// A threshold of a fifth of a floor's width has pipes as well.
TEST_F(FinalFitTest, NarrowPlanesAreRefusedWhereTheThresholdIsAutomatic)
{
    build([](std::size_t, double, double, Dice& dice) { return 0.001 * dice.normal(); });
    hypothesis_.threshold = 0.2;
    EXPECT_EQ(fit(false).primitives.size(), 3u);
    EXPECT_EQ(fit(false, 0.001).primitives.size(), 0u);
    hypothesis_.threshold = 0.15;
    EXPECT_EQ(fit(false, 0.001).primitives.size(), 3u);
}

TEST_F(FinalFitTest, DoubtfulOnesAreLeftOutOnRequestButForThinPipes)
{
    build([](std::size_t floor, double, double, Dice& dice) {
        return floor == 1 ? (dice.unit() < 0.5 ? -1 : 1) * 0.004 + 0.001 * dice.normal() : 0.001 * dice.normal();
    });
    EXPECT_EQ(fit(false, 0.001).primitives.size(), 3u);
    EXPECT_EQ(fit(false, 0.001, true).primitives.size(), 2u);
    hypothesis_.thin = true;
    EXPECT_EQ(fit(false, 0.001, true).primitives.size(), 3u);
}

TEST_F(FinalFitTest, WhatWasFoundAlongAStripIsDoubtful)
{
    build([](std::size_t, double, double, Dice& dice) { return 0.001 * dice.normal(); });
    for (const Primitive& floor : fit(false).primitives) EXPECT_EQ(floor.fit.verdict, FitVerdict::good);
    hypothesis_.of_strip = true;
    const FinalFit doubted = fit(false);
    ASSERT_EQ(doubted.primitives.size(), 3u);
    for (const Primitive& floor : doubted.primitives) {
        EXPECT_EQ(floor.fit.verdict, FitVerdict::doubtful);
        EXPECT_NE(floor.fit.message.find("narrow strip"), std::string::npos) << floor.fit.message;
    }
}

}  // namespace
