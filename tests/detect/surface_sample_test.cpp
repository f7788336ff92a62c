// Samples of boxes, what they say of a cloud, and labels of its points.

#include "pcm/detect/surface_sample.h"

#include "pcm/detect/cloud_survey.h"
#include "pcm/detect/hypotheses.h"
#include "pcm/detect/point_labels.h"
#include "tests/place/shape_cloud.h"

#include <algorithm>
#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;

class SurfaceSamples : public testing::Test {
protected:
    // A floor of 2 x 2 with a wall at x = 1, 2000 points each, 0.002 rough, and a far point.
    SurfaceSamples()
    {
        Dice dice(6);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 2000; ++i) {
            points.push_back({{dice.between(-1, 1), dice.between(-1, 1), 0.002 * dice.normal()}, {}});
            points.push_back({{1 + 0.002 * dice.normal(), dice.between(-1, 1), dice.between(0, 2)}, {}});
        }
        points.push_back({{0, 0, 3}, {}});
        tree_ = build_surface_tree(folder_.path(), points);
    }
    SurfaceSample sample(double cell, double margin = 0, double step = 0) const
    {
        const ChosenPoints chosen(tree_, {});
        Box3i half = tree_->info().box;
        half.max[1] = half.min[1] + (half.max[1] - half.min[1]) / 2;  // y < 0
        return sample_surface(chosen, half, {tree_->info().levels, cell, margin, step});
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
};

TEST_F(SurfaceSamples, HaveOnePointOfEachCellOfTheBoxAndItsMargin)
{
    const SampleLattice lattice(*tree_, 0.1);
    std::set<std::uint64_t> inside, around;
    std::size_t all = 0;
    for (const PlacedPoint& p : all_points(*tree_)) {
        const Vec3i grid = tree_->read_chunk(p.node, ColumnSet::only_positions()).positions->grid(p.number);
        const std::uint64_t key = SampleLattice::key_of(lattice.cell_of(grid));
        if (p.position[1] < -1e-3) inside.insert(key), ++all;
        if (p.position[1] < 0.299) around.insert(key);
    }
    const SurfaceSample thin = sample(0.1, 0.3);
    EXPECT_GE(thin.size(), around.size());
    EXPECT_EQ(thin.by_cell.size(), thin.size());
    for (const std::uint64_t key : inside) EXPECT_TRUE(thin.by_cell.count(key));
    for (std::size_t i = 0; i < thin.size(); ++i) {
        const double y = thin.origin[1] + thin.at[i][1];
        EXPECT_LT(y, 0.302);
        if (std::fabs(y) > 1e-3) EXPECT_EQ(thin.inside[i] != 0, y < 0);
    }
    EXPECT_NEAR(static_cast<double>(sample(0).size()), static_cast<double>(all), 10);  // all points
}

TEST_F(SurfaceSamples, HaveTheNearestNeighboursNormalsAndSpacings)
{
    const SurfaceSample s = sample(0, 0.3);
    std::size_t flat = 0, level = 0;
    for (std::uint32_t i = 0; i < s.size(); i += 7) {
        std::vector<double> squares;
        for (const Vec3d& p : s.at) squares.push_back(squared_distance(p, s.at[i]));
        std::sort(squares.begin(), squares.end());
        EXPECT_FLOAT_EQ(s.spacing[i], static_cast<float>(std::sqrt(squares[4])));
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) {
            const std::uint32_t j = s.neighbours(i)[k];
            const double d = squared_distance(s.at[i], s.at[j]);
            if (j != i) EXPECT_DOUBLE_EQ(d, squares[k + 1]);
        }
        const Vec3d p = s.origin + s.at[i];
        if (p[2] > 2.5 || p[0] > 0.7 || p[0] < -0.9 || p[1] < -0.9) continue;
        ++flat;
        level += std::fabs(s.normal_of(i)[2]) > 0.995;
        EXPECT_LT(s.rough[i], 0.004);
        EXPECT_GT(s.rough[i], 0.0005);
    }
    EXPECT_GT(flat, 100u);
    EXPECT_EQ(level, flat);
}

TEST_F(SurfaceSamples, EdgesAreCutAtTheStepOrWhereTheSpacingEnds)
{
    const SurfaceSample s = sample(0);
    for (std::uint32_t i = 0; i < s.size(); ++i) {
        const bool far = (s.origin + s.at[i])[2] > 2.5;
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) {
            const std::uint32_t j = s.neighbours(i)[k];
            if (far) EXPECT_EQ(j, i);  // it is near nothing
            EXPECT_LE(std::sqrt(squared_distance(s.at[i], s.at[j])), 2.501 * std::min(s.spacing[i], s.spacing[j]));
        }
    }
    const SurfaceSample narrow = sample(0, 0, 0.04);
    std::size_t edges = 0;
    for (std::uint32_t i = 0; i < narrow.size(); ++i)
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) {
            edges += narrow.neighbours(i)[k] != i;
            EXPECT_LE(squared_distance(narrow.at[i], narrow.at[narrow.neighbours(i)[k]]), 0.04 * 0.04);
        }
    EXPECT_GT(edges, narrow.size());
    const SurfaceSample thin = sample(0.1);  // three cells are near in any case
    for (std::uint32_t i = 0; i < thin.size(); ++i) {
        std::size_t near = 0, reached = 0;
        for (const Vec3d& p : thin.at) near += squared_distance(p, thin.at[i]) < 0.299 * 0.299;
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k) reached += thin.neighbours(i)[k] != i;
        EXPECT_GE(reached, std::min(near - 1, SurfaceSample::most_neighbours));
    }
}

// Next to the wall a strip of the floor, and what is up to 0.2 above it: points well inside have the same neighbours.
TEST_F(SurfaceSamples, InVicinitiesHaveTheirPointsAloneWithTheSameNeighbours)
{
    const ChosenPoints chosen(tree_, {});
    SampleSettings settings{tree_->info().levels};
    const SurfaceSample all = sample_surface(chosen, tree_->info().box, settings);
    Vicinity strip;
    strip.box = {{-0.5, -2, -1}, {2, 2, 5}};
    strip.shape.axis = {0, 0, 1};
    strip.most = 0.2;
    const Vicinity elsewhere{{{50, 50, 50}, {51, 51, 51}}, strip.shape, 100};
    settings.only = {elsewhere, strip};
    const SurfaceSample some = sample_surface(chosen, tree_->info().box, settings);
    std::size_t next = 0, compared = 0;
    std::vector<std::size_t> from;  // numbers in `all`
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Vec3d p = all.origin + all.at[i];
        if (p[0] < -0.5 || std::fabs(p[2]) > 0.2) continue;
        ASSERT_LT(next, some.size());
        EXPECT_EQ(some.at[next++], all.at[i]);
        from.push_back(i);
    }
    EXPECT_EQ(next, some.size());
    EXPECT_GT(next, 1000u);
    EXPECT_LT(next, all.size() / 2);
    for (std::size_t i = 0; i < some.size(); ++i) {
        const Vec3d p = some.origin + some.at[i];
        if (p[0] < -0.2 || p[0] > 0.8 || std::fabs(p[1]) > 0.8) continue;
        ++compared;
        EXPECT_EQ(some.normal[i], all.normal[from[i]]);
        for (std::size_t k = 0; k < SurfaceSample::most_neighbours; ++k)
            EXPECT_EQ(from[some.neighbours(i)[k]], all.neighbours(from[i])[k]);
    }
    EXPECT_GT(compared, 300u);
    settings.only = {elsewhere};
    EXPECT_EQ(sample_surface(chosen, tree_->info().box, settings).size(), 0u);
}

TEST_F(SurfaceSamples, AreOfTheLevelsAndTheSelectionAskedFor)
{
    const auto count = [&](const Selection& limit, std::uint16_t level) {
        std::uint64_t points = 0;
        ChosenPoints(tree_, limit).visit(tree_->info().box, level, [&](const ChosenPoints::Some& some) {
            points += some.number.size();
            for (const Vec3d& p : some.at)
                if (limit.box) EXPECT_TRUE(limit.box->contains(p));
        });
        return points;
    };
    Dice dice(4);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 6000; ++i) points.push_back({{dice.between(-1, 1), dice.between(-1, 1), 0}, {}});
    tree_ = build_surface_tree(folder_.path(), points, false, 25000);  // chunks of several levels
    ASSERT_GE(tree_->info().levels, 2u);
    ASSERT_LT(tree_->points_to_level(0), tree_->info().points);
    for (std::uint16_t level = 0; level < tree_->info().levels; ++level)
        EXPECT_EQ(count({}, level), tree_->points_to_level(level));
    Selection limit;
    limit.box = Box3d{{-0.5, -0.5, -1}, {0.5, 0.5, 1}};
    EXPECT_NEAR(static_cast<double>(count(limit, tree_->info().levels)), 1500, 150);
}

TEST_F(SurfaceSamples, PointsNearAShapeAreAllGivenInOrder)
{
    const SurfaceSample s = sample(0, 0.3);
    Dice dice(3);
    for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere})
        for (int round = 0; round < 20; ++round) {
            pcm::Shape shape;
            shape.kind = kind;
            shape.point = {dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)};
            shape.axis = dice.direction();
            shape.radius = kind == ShapeKind::plane ? 0 : dice.between(0.1, 1);
            const Vec3d low{dice.between(-1, 0), dice.between(-1, 0), dice.between(-1, 0)};
            const Box3d box{s.origin + low, s.origin + low + Vec3d{1, 0.8, 1.2}};
            const double most = dice.between(0, 0.1);
            std::vector<std::uint32_t> given;
            for_points_near(s, box, shape, most, [&](std::uint32_t i) { given.push_back(i); });
            EXPECT_TRUE(std::is_sorted(given.begin(), given.end()));
            for (const std::uint32_t i : given) EXPECT_TRUE(box.contains(s.origin + s.at[i]));
            for (std::uint32_t i = 0; i < s.size(); ++i)
                if (box.contains(s.origin + s.at[i]) && distance_to(shape, s.at[i]) <= most)
                    EXPECT_TRUE(std::binary_search(given.begin(), given.end(), i));
        }
}

TEST_F(SurfaceSamples, TheSurveyFindsSpacingAndNoise)
{
    const ChosenPoints chosen(tree_, {});
    int checks = 0;
    const CloudSurvey survey = survey_cloud(chosen, {tree_->info().box}, Repeated::counted, [&] { ++checks; });
    EXPECT_EQ(checks, 1);
    const double spacing = std::sqrt(1 / (pi * 500));  // within which a point has another one on average
    EXPECT_NEAR(survey.spacing, 1.67 * spacing, 0.1 * spacing);
    EXPECT_GT(survey.noise, 0.002);  // the larger part of it
    EXPECT_LT(survey.noise, 0.004);
    EXPECT_EQ(survey_cloud(chosen, {}, Repeated::counted, [] {}).spacing, 0);
}

TEST_F(SurfaceSamples, TheSurveyFindsNoiseThatIsWiderThanTheSpacing)
{
    Dice dice(6);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 20000; ++i)
        points.push_back({{dice.between(0, 0.5), dice.between(0, 0.5), 0.01 * dice.normal()}, {}});
    tree_ = build_surface_tree(folder_.path(), points);
    const CloudSurvey survey = survey_cloud(ChosenPoints(tree_, {}), {tree_->info().box}, Repeated::counted, [] {});
    EXPECT_GT(survey.noise, 0.009);
    EXPECT_LT(survey.noise, 0.016);
}

// More than half of the cloud is bushes.
TEST_F(SurfaceSamples, TheSurveyFindsTheNoiseOfSurfacesAmongClutter)
{
    Dice dice(6);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 4000; ++i)
        points.push_back({{dice.between(0, 1), dice.between(0, 1), 0.002 * dice.normal()}, {}});
    for (int i = 0; i < 5400; ++i)
        points.push_back({{dice.between(0, 1), dice.between(0, 1), dice.between(0.3, 1.3)}, {}});
    tree_ = build_surface_tree(folder_.path(), points);
    const CloudSurvey survey = survey_cloud(ChosenPoints(tree_, {}), {tree_->info().box}, Repeated::counted, [] {});
    EXPECT_GT(survey.noise, 0.002);
    EXPECT_LT(survey.noise, 0.005);
}

TEST_F(SurfaceSamples, LabelsAreThoseThatWereSet)
{
    PointLabels labels(*tree_);
    ASSERT_GE(tree_->nodes().size(), 2u);
    const std::vector<std::uint32_t> numbers{0, 1, 2, 5, 7, 8}, given{9, 8, 7, 6, 5, 4};
    labels.set(1, numbers, given.data());
    const std::vector<std::uint32_t> found = labels.get(1);
    ASSERT_EQ(found.size(), tree_->node(1).points);
    for (std::uint32_t i = 0; i < found.size(); ++i) {
        const auto at = std::find(numbers.begin(), numbers.end(), i);
        EXPECT_EQ(found[i], at == numbers.end() ? 0 : given[static_cast<std::size_t>(at - numbers.begin())]) << i;
    }
    labels.set_all(0, std::vector<std::uint32_t>(tree_->node(0).points, 3));
    EXPECT_EQ(labels.get(1), found);
    EXPECT_EQ(labels.get(0), std::vector<std::uint32_t>(tree_->node(0).points, 3));
}

TEST_F(SurfaceSamples, HaveNoPointsThatAreTaken)
{
    const auto labels = std::make_shared<PointLabels>(*tree_);
    std::size_t wall = 0, all = 0;
    for (const PlacedPoint& p : all_points(*tree_)) {
        const std::uint32_t label = p.position[2] > 0.1 ? 7 : 0;
        labels->set(p.node, {p.number}, &label);
        wall += label != 0;
        ++all;
    }
    ASSERT_GT(wall, 1000u);
    const ChosenPoints chosen(tree_, {}, {}, {labels});
    const SurfaceSample left = sample_surface(chosen, tree_->info().box, {tree_->info().levels, 0});
    EXPECT_EQ(left.size(), all - wall);
    for (const Vec3d& p : left.at) EXPECT_LE(p[2] + left.origin[2], 0.1 + 1e-3);
    std::vector<bool> open(8, false);
    const auto count = [&] {
        return sample_surface(ChosenPoints(tree_, {}, {}, {labels, open}), tree_->info().box, {tree_->info().levels, 0})
            .size();
    };
    EXPECT_EQ(count(), all - wall);
    open[6] = true;  // label 7
    EXPECT_EQ(count(), all);
}

// Those near it whose normals agree, within its reach.
TEST_F(SurfaceSamples, KnownShapesExplainPoints)
{
    const SurfaceSample all = sample_surface(ChosenPoints(tree_, {}), tree_->info().box, {tree_->info().levels, 0});
    Hypothesis floor;
    floor.box = {{-1, -1, 0}, {0, 1, 0}};
    ExplainedLimits limits;
    limits.threshold = 0.01;
    limits.reach = 0.25;
    limits.normal_angle = 0.3;
    std::vector<std::uint8_t> taken(all.size(), 0);
    mark_explained(all, {floor}, limits, taken);
    std::size_t count = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Vec3d p = all.at[i] + all.origin;
        const bool near = p[0] <= 0.25 && std::fabs(p[2]) <= 0.01 && std::fabs(all.normal_of(i)[2]) >= std::cos(0.3);
        EXPECT_EQ(taken[i] != 0, near) << p[0] << ' ' << p[2];
        count += near;
    }
    EXPECT_GT(count, 1000u);
}

TEST(Hypothesis, ItsPointsMayLieAsFarOutsideOfItsBoxAsItReaches)
{
    Hypothesis one;
    one.box = {{0, 1, 2}, {1, 2, 3}};
    one.reach = 0.5;
    EXPECT_EQ(reached_box(one, 0.25), (Box3d{{-0.5, 0.5, 1.5}, {1.5, 2.5, 3.5}}));
    EXPECT_EQ(reached_box(one, 1), (Box3d{{-1, 0, 1}, {2, 3, 4}}));
}

}  // namespace
