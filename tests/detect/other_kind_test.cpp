// Pieces of shapes that bend more than what was fitted to them.
#include "pcm/detect/other_kind.h"

#include "pcm/detect/detect.h"
#include "tests/place/shape_cloud.h"

#include <algorithm>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double kind_noise = 0.001, kind_threshold = 0.006;

pcm::Shape kind_of(ShapeKind kind, double radius, double second = 0)
{
    pcm::Shape shape;
    shape.kind = kind;
    shape.radius = radius;
    shape.second = second;
    return shape;
}

// The kind that explains 500 points of a part of a shape better than one of `kind` that is fitted to them.
std::optional<ShapeKind> found_for(const pcm::Shape& truth, ShapeKind kind, double from, double to, double arc)
{
    Dice dice(6);
    std::vector<Vec3d> points;
    while (points.size() < 500) {
        const double a = dice.between(0, arc), h = dice.between(from, to);
        const double r = truth.kind == ShapeKind::cone ? h * std::tan(truth.second) : truth.radius;
        const Vec3d p = truth.kind == ShapeKind::plane ? Vec3d{a, h, 0} : Vec3d{r * std::cos(a), r * std::sin(a), h};
        points.push_back(p + kind_noise * dice.normal() * normal_at(truth, p));
    }
    ShapeFitOptions options;
    options.kind = kind;
    options.threshold = kind_threshold;
    ShapeFit fit = fit_shape(FitPoints::of(points), options);
    EXPECT_TRUE(fit.has_shape());
    fit.verdict = FitVerdict::doubtful;
    return other_kind(fit, points);
}

TEST(OtherKind, ConesAreNotCylindersOrPlanes)
{
    const pcm::Shape cone = kind_of(ShapeKind::cone, 0, 0.3);
    EXPECT_EQ(found_for(cone, ShapeKind::cylinder, 0.9, 1.1, 1.2), ShapeKind::cone);
    EXPECT_TRUE(found_for(cone, ShapeKind::plane, 0.9, 1.1, 0.35));
}

TEST(OtherKind, PipesAreNotPlanes)
{
    EXPECT_EQ(found_for(kind_of(ShapeKind::cylinder, 0.1), ShapeKind::plane, 0, 1, 0.6), ShapeKind::cylinder);
}

TEST(OtherKind, FloorsThatBendALittleAreFloors)
{
    EXPECT_FALSE(found_for(kind_of(ShapeKind::cylinder, 3), ShapeKind::plane, 0, 1, 0.12));
}

TEST(OtherKind, WhatIsOfItsKindIsNotOfAnother)
{
    EXPECT_FALSE(found_for(kind_of(ShapeKind::cylinder, 0.1), ShapeKind::cylinder, 0, 1, 2));
    EXPECT_FALSE(found_for(kind_of(ShapeKind::plane, 0), ShapeKind::plane, 0, 1, 1));
}

// A floor, and a cone of which cylinders are cut out.
TEST(OtherKind, PiecesOfConesAreLeftOutWithANote)
{
    Dice dice(12);
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 30000; ++i)
        points.push_back({{dice.between(-3, 3), dice.between(-3, 3), 0.0015 * dice.normal()}, {}});
    for (int i = 0; i < 12000; ++i) {
        const double a = dice.between(0, 2 * pi), h = dice.between(0.2, 1.2),
                     r = 0.12 + 0.35 * h + 0.0015 * dice.normal();
        points.push_back({{r * std::cos(a), r * std::sin(a), h}, {}});
    }
    const TemporaryFolder folder;
    const DetectReport report = detect_primitives(build_surface_tree(folder.path(), points), {});
    const auto is_round = [](const Primitive& one) { return !traits_of(one.fit.shape.kind).is_flat(); };
    EXPECT_EQ(std::count_if(report.primitives.begin(), report.primitives.end(), is_round), 0);
    const auto is_of_cones = [](const std::string& note) { return note.find("cones") != std::string::npos; };
    EXPECT_EQ(std::count_if(report.notes.begin(), report.notes.end(), is_of_cones), 1);
}

}  // namespace
