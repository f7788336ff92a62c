// Which surface a point belongs to, and what is made of the parts.

#include "pcm/detect/assign_points.h"

#include "pcm/detect/border_cells.h"
#include "pcm/detect/final_fit.h"
#include "pcm/place/extreme_points.h"
#include "pcm/system/error.h"
#include "tests/place/shape_cloud.h"

#include <algorithm>

namespace {

using namespace pcm;
using namespace pcm::test;

class AssignPoints : public testing::Test {
protected:
    void make(const std::vector<Vec3d>& positions)
    {
        std::vector<SurfacePoint> points;
        for (const Vec3d& p : positions) points.push_back({p, {}});
        tree_ = build_surface_tree(folder_.path(), points);
    }
    static Hypothesis level_plane(double height, double threshold)
    {
        Hypothesis one;
        one.shape.point = {0, 0, height};
        one.box.extend(Vec3d{-2, -2, height});
        one.box.extend(Vec3d{2, 2, height});
        one.threshold = threshold;
        return one;
    }
    // The fit of the plane z = 0 and one part, to which all points with a label belong.
    FinalFit fit_all(const std::function<std::uint32_t(const Vec3d&)>& label) const
    {
        PointLabels labels(*tree_);
        AssignedPoints assigned;
        assigned.parts.resize(1);
        for (const PlacedPoint& p : all_points(*tree_)) {
            const std::uint32_t one = label(p.position);
            labels.set(p.node, {p.number}, &one);
            assigned.parts[0].box.extend(p.position);
            assigned.parts[0].points += one != 0;
        }
        assigned.numbers = {{0, 0}};
        FinalFitOptions options;
        options.least_points = 500;
        options.progress = [](double) {};
        return fit_parts(ChosenPoints(tree_, {}), {level_plane(0, 0.01)}, assigned, labels, options);
    }
    AssignOptions options_of(double cell, std::uint64_t least_points) const
    {
        AssignOptions options;
        options.sample = {tree_->info().levels, cell, 8 * cell};
        options.normal_angle = 0.6;
        options.reach = 0.1;
        options.least_points = least_points;
        options.progress = [](double) {};
        return options;
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
};

// Two floors that meet at a small step: all points are within the threshold of both.
TEST_F(AssignPoints, APointBelongsToTheNearestSurfaceNotToTheFirst)
{
    std::vector<Vec3d> points;
    for (int i = -50; i < 50; ++i)
        for (int j = -25; j < 25; ++j) points.push_back({0.02 * i + 0.03, 0.02 * j, i < 0 ? 0.0 : 0.006});
    make(points);
    const ChosenPoints chosen(tree_, {});
    for (const double cell : {0.01, 0.05})  // each point a cell; cells with points of both
        for (const bool low_first : {true, false}) {
            const double heights[] = {low_first ? 0.0 : 0.006, low_first ? 0.006 : 0.0};
            const std::vector<Hypothesis> hypotheses{level_plane(heights[0], 0.01), level_plane(heights[1], 0.01)};
            const AssignOptions options = options_of(cell, 0);
            PointLabels labels(*tree_);
            const AssignedPoints assigned = assign_points(chosen, {tree_->info().box}, hypotheses, options, &labels);
            std::size_t wrong = 0;
            for (const PlacedPoint& p : all_points(*tree_)) {
                const std::uint32_t label = labels.get(p.node)[p.number] & ~interior_label;
                ASSERT_GT(label, 0u);
                const SurfacePart& part = assigned.parts.at(assigned.part_of(label));
                wrong += std::fabs(heights[part.hypothesis] - p.position[2]) > 1e-6;
            }
            EXPECT_EQ(wrong, 0u) << cell << " " << low_first;
        }
}

// A floor of 2 x 1 with a wall at its end, in two units whose border crosses both.
TEST_F(AssignPoints, PartsAreJoinedAcrossUnitsAndCornersAreNotInside)
{
    std::vector<Vec3d> points;
    for (int i = 0; i < 100; ++i)
        for (int j = -25; j < 25; ++j) {
            points.push_back({-0.02 * i, 0.02 * j + 0.005, 0});
            if (i > 0 && i < 50) points.push_back({0, 0.02 * j + 0.005, 0.02 * i});
        }
    for (const double y : {0.01, 0.012, 0.014, 0.016}) points.push_back({-1.981 - y, y, 0});
    make(points);
    Hypothesis wall = level_plane(0, 0.01);
    wall.shape.axis = {1, 0, 0};
    wall.box = {{0, -2, -2}, {0, 2, 2}};
    Box3i low = tree_->info().box, high = low;
    low.max[1] = low.min[1] + (low.max[1] - low.min[1]) / 2;
    high.min[1] = low.max[1] + 1;
    const AssignOptions options = options_of(0.05, 500);
    PointLabels labels(*tree_);
    const AssignedPoints assigned =
        assign_points(ChosenPoints(tree_, {}), {low, high}, {level_plane(0, 0.01), wall}, options, &labels);
    ASSERT_EQ(assigned.parts.size(), 2u);
    for (const SurfacePart& part : assigned.parts) {
        EXPECT_NEAR(static_cast<double>(part.points), part.hypothesis == 0 ? 5000 : 2450, 60);
        EXPECT_GT(part.edge, 15u);  // one cell next to the other surface, or two
        EXPECT_LT(part.edge, 120u);
        EXPECT_EQ(part.continued, 0u);
        EXPECT_NEAR(part.box.extent(1), 0.98, 1e-9);  // extent of all points, not only the sample's
        if (part.hypothesis == 0) EXPECT_NEAR(part.box.min[0], -1.997, 1e-9);
    }
    for (const PlacedPoint& p : all_points(*tree_)) {
        const bool inside = labels.get(p.node)[p.number] & interior_label;
        if (std::max(-p.position[0], p.position[2]) < 0.03) EXPECT_FALSE(inside);
        if (std::max(-p.position[0], p.position[2]) > 0.4) EXPECT_TRUE(inside);
    }
}

TEST_F(AssignPoints, ThePartsOfABendContinueInEachUnit)
{
    std::vector<Vec3d> points;
    for (int i = -100; i < 100; ++i)
        for (int j = -25; j < 25; ++j) points.push_back({0.02 * i, 0.02 * j, 0.01 * i * i * 0.0004});
    make(points);  // 0.04 high at the ends
    Box3i low = tree_->info().box, high = low;
    low.max[1] = low.min[1] + (low.max[1] - low.min[1]) / 2;
    high.min[1] = low.max[1] + 1;
    const AssignOptions options = options_of(0.02, 0);
    const auto continued = [&](const std::vector<Box3i>& units) {
        const AssignedPoints assigned =
            assign_points(ChosenPoints(tree_, {}), units, {level_plane(0, 0.01)}, options, nullptr);
        std::uint64_t most = 0;
        for (const SurfacePart& part : assigned.parts) most = std::max(most, part.continued);
        return most;
    };
    const std::uint64_t whole = continued({tree_->info().box});
    EXPECT_GT(whole, 60u);
    EXPECT_NEAR(static_cast<double>(continued({low, high})), static_cast<double>(whole), 10);
}

// The other face of a plate lies within a few thresholds, with the same normals, but not next to the edge of this one.
TEST_F(AssignPoints, ThePartsOfAPlateDoNotContinueAsItsOtherFace)
{
    Dice dice(3);
    std::vector<Vec3d> points;
    for (int i = 0; i < 12000; ++i)
        points.push_back(
            {dice.between(-2, 2), dice.between(-0.5, 0.5), (i % 2 ? -0.014 : 0.0) + 0.0015 * dice.normal()});
    make(points);
    const AssignOptions options = options_of(0.01, 0);
    for (const bool has_both : {false, true}) {
        std::vector<Hypothesis> faces{level_plane(0, 0.007)};
        if (has_both) faces.push_back(level_plane(-0.014, 0.007));
        const AssignedPoints assigned =
            assign_points(ChosenPoints(tree_, {}), {tree_->info().box}, faces, options, nullptr);
        const SurfacePart& face = assigned.parts.at(0);
        EXPECT_GT(face.edge, 4000u);
        EXPECT_LT(face.continued, face.edge / 20) << has_both;
        EXPECT_FALSE(is_piece(face, 0.007));
    }
}

// A crest with a narrow ledge on each side, three thresholds lower, and a slope below: whether the surface continues is
// decided by the ledge, whose normals come from points of the slope beyond four thresholds. Along the crest the plane
// ends where it may reach, amid points.
TEST_F(AssignPoints, PartsAreTheSameWithPointsOfTheirVicinityAlone)
{
    Dice dice(7);
    std::vector<Vec3d> points;
    for (int i = 0; i < 40000; ++i) {
        const double x = dice.between(-1, 1), y = dice.between(-1, 1), flank = std::fabs(x) - 0.3;
        const double height = flank < 0 ? 0 : -0.0105 - 2 * std::max(0.0, flank - 0.04);
        points.push_back({x, y, height + 0.0005 * dice.normal()});
    }
    make(points);
    Hypothesis crest = level_plane(0, 0.0035);
    crest.box = {{-0.3, -0.5, 0}, {0.3, 0.5, 0}};
    AssignOptions options = options_of(0.02, 0);
    const auto parts = [&] {
        return assign_points(ChosenPoints(tree_, {}), {tree_->info().box}, {crest}, options, nullptr).parts;
    };
    const std::vector<SurfacePart> all = parts();
    options.sample.only = {vicinity_of(crest, options)};
    const std::vector<SurfacePart> near = parts();
    ASSERT_EQ(near.size(), all.size());
    EXPECT_GT(all[0].sampled, 1500u);
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(near[i].sampled, all[i].sampled);
        EXPECT_EQ(near[i].edge, all[i].edge);
        EXPECT_EQ(near[i].continued, all[i].continued);
        EXPECT_NEAR(near[i].squares, all[i].squares, 1e-9 * all[i].squares);
        EXPECT_NEAR(near[i].smooth_squares, all[i].smooth_squares, 1e-9 * all[i].smooth_squares);
    }
}

// Sums over the points inside a part, of their distances and of the means of theirs and their neighbours'.
TEST_F(AssignPoints, PartsHaveTheSquaresOfTheirPointsInside)
{
    Dice dice(7);
    std::vector<Vec3d> points;
    for (int i = 0; i < 4000; ++i) points.push_back({dice.between(-1, 1), dice.between(-1, 1), 0.002 * dice.normal()});
    make(points);
    const ChosenPoints chosen(tree_, {});
    const AssignOptions options = options_of(0.001, 0);
    const AssignedPoints found = assign_points(chosen, {tree_->info().box}, {level_plane(0, 0.05)}, options, nullptr);
    ASSERT_EQ(found.parts.size(), 1u);
    const SurfaceSample sample = sample_surface(chosen, tree_->info().box, options.sample);
    double squares = 0, smooth = 0;
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const double z = sample.at[i][2] + sample.origin[2];
        double sum = z;
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k)
            sum += sample.at[sample.neighbours(i)[k]][2] + sample.origin[2];
        squares += z * z;
        smooth += sum * sum / (17.0 * 17.0);
    }
    const SurfacePart& part = found.parts[0];
    EXPECT_EQ(part.edge, 0u);
    EXPECT_NEAR(part.squares, squares, 1e-9 * squares);
    EXPECT_NEAR(part.smooth_squares, smooth, 1e-9 * smooth);
}

// A thin pipe's points have any normals; without points of a hypothesis, none is kept.
TEST_F(AssignPoints, ThinPipesHavePointsOfAnyNormalAndPointsAreKeptOnRequest)
{
    Dice dice(7);
    std::vector<Vec3d> points;
    for (int i = 0; i < 3000; ++i)
        points.push_back({dice.between(-1, 1), dice.between(-0.02, 0.02), dice.between(-0.02, 0.02)});
    make(points);
    Hypothesis one = level_plane(0, 0.03);
    const ChosenPoints chosen(tree_, {});
    AssignOptions options = options_of(0.001, 0);
    const auto sampled = [&] {
        std::uint64_t all = 0, kept = 0;
        for (const SurfacePart& part : assign_points(chosen, {tree_->info().box}, {one}, options, nullptr).parts) {
            all += part.sampled;
            kept += part.some.size();
        }
        EXPECT_EQ(kept > 0, options.some_from == 0);
        return all;
    };
    EXPECT_LT(sampled(), 2500u);
    one.thin = true;
    EXPECT_GT(sampled(), 2990u);
    options.some_from = 0;
    EXPECT_GT(sampled(), 2990u);
    options.some_from = 1;
    EXPECT_GT(sampled(), 2990u);
}

TEST_F(AssignPoints, NormalsDecideWithinTheThreshold)
{
    std::vector<Vec3d> points;
    for (int i = 0; i < 1000; ++i)
        for (int j = -3; j <= 3; ++j) points.push_back({0.002 * i, 0, 0.002 * j});  // a strip on edge
    make(points);
    PointLabels labels(*tree_);
    const AssignOptions options = options_of(0.001, 0);
    assign_points(ChosenPoints(tree_, {}), {tree_->info().box}, {level_plane(0, 0.01)}, options, &labels);
    std::size_t given = 0;
    for (const PlacedPoint& p : all_points(*tree_)) given += labels.get(p.node)[p.number] != 0;
    EXPECT_EQ(given, 0u);
}

TEST_F(AssignPoints, StepsJoinWhatIsNoFartherApart)
{
    std::vector<Vec3d> points;
    for (int i = 0; i < 50; ++i)
        for (int j = 0; j < 50; ++j)
            for (const double x : {0.0, 1.28}) points.push_back({x + 0.02 * i, 0.02 * j, 0});  // 0.3 apart
    for (int i = 0; i < 20; ++i) points.push_back({-1.5 + 0.02 * (i % 5), 0.02 * (i / 5), 0});
    make(points);
    for (const std::uint64_t least_sampled : {0, 100}) {  // without labels there are no numbers of points
        AssignOptions options = options_of(0.01, 0);
        options.least_sampled = least_sampled;
        const AssignedPoints assigned =
            assign_points(ChosenPoints(tree_, {}), {tree_->info().box}, {level_plane(0, 0.01)}, options, nullptr);
        EXPECT_EQ(assigned.parts.size(), least_sampled > 0 ? 2u : 3u);
    }
    for (const double step : {0.0, 0.25, 0.32}) {
        AssignOptions options = options_of(0.01, 100);
        options.sample.step = step;
        options.sample.margin = std::max(0.1, 1.01 * step);
        PointLabels labels(*tree_);
        const AssignedPoints assigned =
            assign_points(ChosenPoints(tree_, {}), {tree_->info().box}, {level_plane(0, 0.01)}, options, &labels);
        EXPECT_EQ(assigned.parts.size(), step > 0.3 ? 1u : 2u) << step;
    }
}

TEST_F(AssignPoints, PointsOnOneLineEndNoDetection)
{
    std::vector<Vec3d> points;
    for (int i = 0; i < 2000; ++i) points.push_back({0.001 * i, 0, 0});
    make(points);
    const FinalFit result = fit_all([](const Vec3d&) { return 1 | interior_label; });
    ASSERT_EQ(result.primitives.size(), 1u);
    EXPECT_EQ(result.unbounded, 1u);
}

// 400 of 10,000 points of the sample are at the edge.
TEST_F(AssignPoints, PiecesContinueAlongTheEdgeAndFillTheThresholdTogether)
{
    const double threshold = 0.01;
    SurfacePart part;
    part.sampled = 10000;
    part.edge = 400;
    part.continued = 200;
    part.squares = 9600 * 0.005 * 0.005;  // half of the threshold
    part.smooth_squares = 0.8 * part.squares;
    EXPECT_TRUE(is_piece(part, threshold));
    SurfacePart other = part;
    other.smooth_squares = 0.1 * part.squares;  // noise
    EXPECT_FALSE(is_piece(other, threshold));
    other = part;
    other.edge = 2000;  // a tenth of the edge
    EXPECT_FALSE(is_piece(other, threshold));
    other = part;
    other.continued = 140;  // less than one and a half sides of a square
    EXPECT_FALSE(is_piece(other, threshold));
    other = part;
    other.squares = 9600 * 0.0015 * 0.0015;  // it is flat; only the whole outline says otherwise
    other.smooth_squares = 0.8 * other.squares;
    EXPECT_FALSE(is_piece(other, threshold));
    other.continued = other.edge = 420;
    EXPECT_TRUE(is_piece(other, threshold));
}

TEST_F(AssignPoints, PointsAtEdgesAreLabelledButNotFittedTo)
{
    Dice dice(3);
    std::vector<Vec3d> points;
    for (int i = 0; i < 3000; ++i) points.push_back({dice.between(0, 1), dice.between(0, 1), 0.001 * dice.normal()});
    for (int i = 0; i < 900; ++i) points.push_back({dice.between(1, 1.2), dice.between(0, 1), 0.006});
    make(points);
    const auto label = [](const Vec3d& p) { return p[0] < 1 ? 1 | interior_label : 1u; };
    const FinalFit result = fit_all(label);
    ASSERT_EQ(result.primitives.size(), 1u);
    EXPECT_EQ(result.primitives[0].points, 3900u);
    const ShapeFit& fit = result.primitives[0].fit;
    EXPECT_LT(distance_to(fit.shape, {0.5, 0.5, 0}), 1e-4);
    EXPECT_NEAR(fit.errors.position, 0.001 / std::sqrt(3000), 0.2 * 0.001 / std::sqrt(3000));
}

TEST_F(AssignPoints, ErrorsAreLargerWhereNeighboursLeaveTheSurfaceTogether)
{
    Dice dice(3);
    std::vector<Vec3d> points;
    for (int i = 0; i < 5000; ++i) {
        const double x = dice.between(0, 1), y = dice.between(0, 1);
        points.push_back({x, y, 0.001 * dice.normal() + 0.003 * std::sin(20 * x) * std::cos(17 * y)});
    }
    make(points);
    const FinalFit result = fit_all([](const Vec3d&) { return 1 | interior_label; });
    ASSERT_EQ(result.primitives.size(), 1u);
    EXPECT_GT(result.primitives[0].fit.errors.position, 3 * 0.002 / std::sqrt(5000));
}

TEST_F(AssignPoints, PrimitivesThatLoseTheirPointsInTheFitAreNone)
{
    Dice dice(3);
    std::vector<Vec3d> points;
    for (int i = 0; i < 700; ++i)
        points.push_back({dice.between(0, 1), dice.between(0, 1), i < 400 ? 0.0 : 0.05 + 0.001 * i});
    make(points);
    const FinalFit result = fit_all([](const Vec3d&) { return 1 | interior_label; });
    EXPECT_TRUE(result.primitives.empty());
}

TEST_F(AssignPoints, SamplesThatAreTooLargeAreThoseOfHalves)
{
    Dice dice(2);
    std::vector<Vec3d> points;
    for (int i = 0; i < 20000; ++i) points.push_back({dice.between(0, 4), dice.between(0, 1), 0});
    make(points);
    const ChosenPoints chosen(tree_, {});
    SampleSettings settings{tree_->info().levels, 0.01, 0.05};
    const auto count = [](const SurfaceSample& sample) {
        return static_cast<std::size_t>(std::count(sample.inside.begin(), sample.inside.end(), 1));
    };
    const std::size_t whole = count(sample_surface(chosen, tree_->info().box, settings));
    settings.most = 3000;
    std::size_t together = 0, samples = 0;
    for_each_sample(chosen, tree_->info().box, settings, [&](const Box3i& box, const SurfaceSample& sample) {
        EXPECT_LE(count(sample), settings.most);
        EXPECT_LE(sample.size(), settings.most * 4 / 3);
        EXPECT_GT(box.max[0], box.min[0]);
        together += count(sample);
        ++samples;
    });
    EXPECT_GE(samples, 4u);
    EXPECT_GE(together, whole);  // a cell that is cut has a point in both halves
    EXPECT_LE(together, whole + samples * 200);
}

// A step from wall to wall of a full room.
TEST_F(AssignPoints, StepsThatReachMorePointsThanMemoryHoldsAreRefused)
{
    Dice dice(2);
    std::vector<Vec3d> points;
    for (int i = 0; i < 20000; ++i) points.push_back({dice.between(0, 1), dice.between(0, 1), dice.between(0, 1)});
    make(points);
    const ChosenPoints chosen(tree_, {});
    const auto sample = [&](double step, double margin) {
        SampleSettings settings{tree_->info().levels, 0.01, margin, step, 3000};
        std::size_t largest = 0;
        for_each_sample(chosen, tree_->info().box, settings,
                        [&](const Box3i&, const SurfaceSample& one) { largest = std::max(largest, one.size()); });
        return largest;
    };
    EXPECT_LE(sample(0.1, 0.1), 6000u);
    try {
        sample(0.9, 0.9);
        FAIL() << "more than 6000 points at once";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find("step of 0.9 reaches more than 6,000 points"), std::string::npos)
            << error.what();
    }
}

TEST(BorderCells, JoinLabelsOfOneSurfaceWithACellInCommonWhateverIsInMemory)
{
    const std::uint64_t far = std::uint64_t(1) << 62;
    for (const std::size_t most : {1u, 2u, 100u}) {
        BorderCells border;
        border.add({{5, 0, 0}, {far, 0, 0}, {7, 1, 4}, {9, 2, 5}});
        border.add({{far, 0, 1}, {far + 5, 0, 1}, {9, 1, 6}});
        border.add({{far + 5, 0, 2}, {7, 0, 3}, {2 * far - 1, 2, 5}});
        JoinedLabels labels(7);
        border.join([&](std::uint32_t a, std::uint32_t b) { labels.join(a, b); }, most);
        for (const std::uint32_t label : {0u, 1u, 2u}) EXPECT_EQ(labels.root(label), 0u);
        for (const std::uint32_t label : {3u, 4u, 5u, 6u}) EXPECT_EQ(labels.root(label), label);
    }
}

TEST(ExtremePoints, BoundAShapeAsAllPointsDo)
{
    Dice dice(8);
    for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere}) {
        pcm::Shape shape;
        shape.kind = kind;
        shape.point = {512345, 4812345, 120};
        shape.axis = normalised(Vec3d{1, 2, 3});
        shape.radius = kind == ShapeKind::plane ? 0 : 0.5;
        ExtremePoints one(shape, shape.point), two(shape, shape.point);
        std::vector<Vec3d> all;
        for (int i = 0; i < 20000; ++i) {
            all.push_back(point_on(shape, 4, 4.5, 0.002, dice).position);
            (i % 3 ? one : two).add(all.back());
        }
        one.add(two);
        EXPECT_LT(one.points().size(), 400u);
        const ShapeBounds kept = bounds_of(shape, one.points(), {}), truth = bounds_of(shape, all, {});
        ASSERT_EQ(kept.outline.size(), truth.outline.size());
        for (std::size_t i = 0; i < truth.outline.size(); ++i)
            EXPECT_LT(length(kept.outline[i] - truth.outline[i]), 1e-7);
        EXPECT_EQ(kept.from, truth.from);
        EXPECT_EQ(kept.to, truth.to);
        EXPECT_EQ(kept.begin, truth.begin);
        EXPECT_EQ(kept.end, truth.end);
    }
}

}  // namespace
