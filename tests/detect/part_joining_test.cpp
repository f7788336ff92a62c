// Parts of planes that are one surface, and others that are not.
#include "pcm/detect/part_joining.h"

#include "tests/place/shape_cloud.h"

#include <functional>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double part_noise = 0.002, part_threshold = 0.008;

class PartJoining : public testing::Test {
protected:
    // Points of z = height + slope x in a rectangle; `noise` draws their distances from it.
    void add(double x0, double x1, double y0, double y1, const std::function<double(Dice&)>& noise, double height = 0,
             double slope = 0, std::size_t count = 250)
    {
        SurfacePart part;
        part.hypothesis = static_cast<std::uint32_t>(hypotheses_.size());
        part.points = part.sampled = 1000 + 10 * hypotheses_.size();
        part.edge = 7;
        part.continued = 3;
        part.mixed = 2;
        part.squares = 2;
        part.smooth_squares = 1;
        for (std::size_t i = 0; i < count; ++i) {
            const double x = dice_.between(x0, x1);
            part.some.push_back({x, dice_.between(y0, y1), height + slope * x + noise(dice_)});
            part.box.extend(part.some.back());
        }
        Hypothesis from;
        from.shape.point = {0, 0, height};
        from.shape.axis = normalised(Vec3d{-slope, 0, 1});
        from.threshold = part_threshold;
        from.box = part.box;
        hypotheses_.push_back(from);
        // Two labels of each part, in turns.
        const auto p = static_cast<std::uint32_t>(assigned_.parts.size());
        assigned_.numbers.push_back({2 * p, p});
        assigned_.numbers.push_back({2 * p + 1, p});
        assigned_.parts.push_back(part);
    }
    // Half of a pipe along x, as a scanner sees it.
    void add_pipe(double x0, double x1, double radius, std::uint64_t points, double height = 0)
    {
        add(x0, x1, 0, 0, normal);
        SurfacePart& part = assigned_.parts.back();
        part.points = points;
        part.box = {};
        for (Vec3d& p : part.some) {
            const double angle = dice_.between(0, pi), away = radius + p[2];
            p = {p[0], away * std::cos(angle), height + away * std::sin(angle)};
            part.box.extend(p);
        }
        hypotheses_.back().shape = {ShapeKind::cylinder, {x0, 0, height}, {1, 0, 0}, radius, 0};
        hypotheses_.back().box = part.box;
    }
    std::size_t joined(double noise = part_noise, std::uint64_t least_points = 500)
    {
        PartJoinOptions options;
        options.spacing = 0.01;
        options.noise = noise;
        options.threshold = part_threshold;
        options.normal_angle = 0.35;
        options.least_points = least_points;
        join_parts(assigned_, hypotheses_, options);
        return assigned_.parts.size();
    }
    static double normal(Dice& dice) { return part_noise * dice.normal(); }

    Dice dice_{8};
    AssignedPoints assigned_;
    std::vector<Hypothesis> hypotheses_;
};

// A web of a beam that two posts stand before, one end of it a millimetre higher.
TEST_F(PartJoining, WhatPostsDivideIsOnePart)
{
    add(0, 4, 0, 0.2, normal);
    add(4.25, 8, 0, 0.2, normal);
    add(8.3, 12, 0, 0.2, normal, 0.001);
    add(0, 12, 3, 3.2, normal);
    ASSERT_EQ(joined(), 2u);
    const std::size_t web = assigned_.parts[0].points > 1030 ? 0 : 1;
    const SurfacePart& part = assigned_.parts[web];
    EXPECT_EQ(part.points, 3030u);
    EXPECT_EQ(part.sampled, 3030u);
    EXPECT_EQ(part.edge, 21u);
    EXPECT_EQ(part.continued, 9u);
    EXPECT_EQ(part.mixed, 6u);
    EXPECT_EQ(part.squares, 6);
    EXPECT_EQ(part.smooth_squares, 3);
    EXPECT_GT(part.box.extent(0), 11.9);
    EXPECT_LE(part.some.size(), 512u);
    const Hypothesis& from = hypotheses_.at(part.hypothesis);
    EXPECT_GT(from.box.extent(0), 11.9);
    EXPECT_EQ(from.threshold, part_threshold);
    for (const double x : {0.0, 6.0}) EXPECT_NEAR(signed_distance(from.shape, {x, 0.1, 0}), 0, 0.0007);
    for (std::uint32_t label = 1; label <= 6; ++label) EXPECT_EQ(assigned_.part_of(label), web);
    for (std::uint32_t label = 7; label <= 8; ++label) EXPECT_EQ(assigned_.part_of(label), 1 - web);
}

TEST_F(PartJoining, FacesOfAPlateStayTwo)
{
    add(0, 4, 0, 0.2, normal);
    add(2, 6, 0, 0.2, normal, 0.007);
    EXPECT_EQ(joined(), 2u);
    add(10, 14, 0, 0.2, normal);
    add(14.2, 18, 0, 0.2, normal, 0.015);
    EXPECT_EQ(joined(), 4u);
    EXPECT_EQ(joined(4 * part_noise), 4u);
}

// The next side of a post, of which no more than a strip lies within the threshold.
TEST_F(PartJoining, AStripOfAnotherFaceStaysOne)
{
    const auto strip = [](Dice& dice) { return dice.between(-0.003, 0.003); };
    add(4.1, 4.1005, 0, 0.2, strip);
    hypotheses_.back().shape.point = {4.1, 0, 0};
    hypotheses_.back().shape.axis = {1, 0, 0};
    add(0, 4, 0, 0.2, normal);
    EXPECT_EQ(joined(), 2u);
}

TEST_F(PartJoining, PlanesThatAreInclinedToEachOtherStayTwo)
{
    add(0, 1, 0, 1, normal);
    add(1.1, 2.1, 0, 1, normal, -1.1 * 0.02, 0.02);
    EXPECT_EQ(joined(), 2u);
}

TEST_F(PartJoining, PartsFarApartStayTwo)
{
    add(0, 4, 0, 0.2, normal);
    add(4.5, 8, 0, 0.2, normal);
    EXPECT_EQ(joined(), 2u);
}

// A square before the long side of a rectangle that is turned by 45 degrees: no edge of the square shows their gap.
TEST_F(PartJoining, ACornerFarFromAnEdgeStaysTwo)
{
    add(1.6, 2.6, -1, 1, normal);
    SurfacePart& turned = assigned_.parts.back();
    turned.box = {};
    for (Vec3d& p : turned.some) {
        p = {(p[0] - p[1]) * std::sqrt(0.5), (p[0] + p[1]) * std::sqrt(0.5), p[2]};
        turned.box.extend(p);
    }
    add(-0.7, 0.7, -0.7, 0.7, normal);
    for (std::size_t i = 0; i < 4; ++i) assigned_.parts[1].some[i] = {i < 2 ? -0.7 : 0.7, i % 2 ? -0.7 : 0.7, 0};
    EXPECT_EQ(joined(), 2u);
}

// Along the sides of a frame: most of the hull has no points.
TEST_F(PartJoining, PartsWithLittleOfTheirHullStayTwo)
{
    add(0, 4, 0, 0.2, normal);
    add(0, 0.2, 0.4, 4, normal);
    EXPECT_EQ(joined(), 2u);
}

TEST_F(PartJoining, PointsThatFillTheThresholdAreNotJoined)
{
    const auto even = [](Dice& dice) { return dice.between(-part_threshold, part_threshold); };
    add(0, 1, 0, 1, even);
    add(1.1, 2.1, 0, 1, even);
    EXPECT_EQ(joined(4 * part_noise), 2u);
}

TEST_F(PartJoining, PlanesOfMoreNoiseThanTheCloudAreNotJoined)
{
    add(0, 1, 0, 1, normal);
    add(1.1, 2.1, 0, 1, normal);
    EXPECT_EQ(joined(0.75 * part_noise), 2u);
    EXPECT_EQ(joined(), 1u);
}

// The points of a tree on a plane are some of those around them.
TEST_F(PartJoining, PartsAmongPointsOfNoSurfaceStayTwo)
{
    add(0, 4, 0, 0.2, normal);
    add(4.1, 8, 0, 0.2, normal);
    assigned_.parts[1].mixed = 150;
    EXPECT_EQ(joined(), 2u);
    assigned_.parts[1].mixed = 50;
    EXPECT_EQ(joined(), 1u);
}

// Cylinders are joined where one of them has too few points by itself.
TEST_F(PartJoining, PiecesOfAPipe)
{
    add_pipe(0, 1, 0.03, 300);
    add_pipe(1.3, 2, 0.03, 200);
    add_pipe(3.5, 5, 0.03, 350);
    add_pipe(6, 6.3, 0.03, 90);
    ASSERT_EQ(joined(), 1u);
    const SurfacePart& part = assigned_.parts[0];
    EXPECT_EQ(part.points, 940u);
    const Hypothesis& from = hypotheses_.at(part.hypothesis);
    EXPECT_EQ(from.shape.kind, ShapeKind::cylinder);
    EXPECT_NEAR(from.shape.radius, 0.03, 0.0005);
    EXPECT_GT(from.box.extent(0), 6.2);
    for (std::uint32_t label = 1; label <= 8; ++label) EXPECT_EQ(assigned_.part_of(label), 0u);
}

TEST_F(PartJoining, PipesThatNeedNoOtherPieceStayTwo)
{
    add_pipe(0, 1, 0.03, 700);
    add_pipe(1.2, 2, 0.03, 500);
    EXPECT_EQ(joined(), 2u);
    EXPECT_EQ(joined(part_noise, 501), 1u);
}

TEST_F(PartJoining, PiecesThatAreNotOnePipeStay)
{
    add_pipe(0, 1, 0.03, 400);
    add_pipe(1.2, 2, 0.0275, 400, 0.001);  // beyond a reducer; 2.5 mm, more than the points' noise
    EXPECT_EQ(joined(), 2u);
    add_pipe(20, 21, 0.03, 400, 0.015);  // next to where they would continue
    add_pipe(21.2, 22, 0.03, 400);
    EXPECT_EQ(joined(), 4u);
    add_pipe(40, 41, 0.03, 400);  // most of the length has no points
    add_pipe(42.5, 42.7, 0.03, 400);
    EXPECT_EQ(joined(), 6u);
}

TEST_F(PartJoining, CurvedPartsAndThoseOfFewPointsStay)
{
    add(0, 4, 0, 0.2, normal);
    add(4.1, 8, 0, 0.2, normal, 0, 0, 19);
    EXPECT_EQ(joined(), 2u);
    add(4.1, 8, 0, 0.2, normal);
    hypotheses_.back().shape.kind = ShapeKind::cylinder;
    hypotheses_.back().shape.radius = 100;
    EXPECT_EQ(joined(), 3u);
    hypotheses_.back().shape.kind = ShapeKind::plane;
    EXPECT_EQ(joined(), 2u);
}

}  // namespace
