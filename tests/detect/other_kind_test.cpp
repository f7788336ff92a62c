// Pieces of shapes that bend more than what was fitted to them.
#include "pcm/detect/other_kind.h"

#include "pcm/detect/detect.h"
#include "tests/place/shape_cloud.h"

#include <algorithm>
#include <cmath>
#include <functional>

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

// The kind in place of a sphere that is fitted to 600 points around the z axis: at distance `r` of angle `a` and
// height.
std::optional<ShapeKind> found_for_sphere(const std::function<Vec3d(double a, Dice&)>& at, std::size_t outside = 0)
{
    Dice dice(9);
    std::vector<Vec3d> points;
    for (int i = 0; i < 600; ++i) points.push_back(at(dice.between(0, 2), dice));
    ShapeFitOptions options;
    options.kind = ShapeKind::sphere;
    options.threshold = kind_threshold;
    const ShapeFit fit = fit_shape(FitPoints::of(points), options);
    EXPECT_TRUE(fit.has_shape());
    for (std::size_t i = 0; i < outside; ++i) {  // on the sphere, but not on the band
        const double a = dice.between(0, 2), up = 0.6 * fit.shape.radius, r = 0.8 * fit.shape.radius;
        points.push_back(fit.shape.point + Vec3d{r * std::cos(a), r * std::sin(a), up});
    }
    return other_kind(fit, points);
}

TEST(OtherKind, BandsOfCylindersAndKnucklesAreNotSpheres)
{
    const auto rims = [](double a, Dice& dice) {
        const double r = 0.19 + kind_noise * dice.normal();
        return Vec3d{r * std::cos(a), r * std::sin(a), dice.between(-0.03, 0.03)};
    };
    EXPECT_EQ(found_for_sphere(rims), ShapeKind::cylinder);
    EXPECT_EQ(found_for_sphere(rims, 40), ShapeKind::cylinder) << "by the points on both";
    const auto knuckle = [](double a, Dice& dice) {
        const double b = dice.between(0.4, 1), r = 0.43 + (0.11 + kind_noise * dice.normal()) * std::cos(b);
        return Vec3d{r * std::cos(a), r * std::sin(a), 0.11 * std::sin(b)};
    };
    EXPECT_EQ(found_for_sphere(knuckle), ShapeKind::torus);
    EXPECT_FALSE(found_for_sphere([](double a, Dice& dice) {
        const double h = dice.between(-0.15, 0.15), r = 0.4 + kind_noise * dice.normal();
        const double out = std::sqrt(r * r - h * h);
        return Vec3d{out * std::cos(a), out * std::sin(a), h};
    })) << "a part of a ball";
}

// A floor, and a cone of which cylinders are cut out: narrow ones, and some as wide as walls.
TEST(OtherKind, PiecesOfConesAreLeftOutWithANote)
{
    for (const double size : {1.0, 3.0}) {
        Dice dice(12);
        std::vector<SurfacePoint> points;
        for (int i = 0; i < 30000; ++i)
            points.push_back({{size * dice.between(-3, 3), size * dice.between(-3, 3), 0.0015 * dice.normal()}, {}});
        for (int i = 0; i < 12000; ++i) {
            const double a = dice.between(0, 2 * pi), h = dice.between(0.2, 1.2),
                         r = size * (0.12 + 0.35 * h) + 0.0015 * dice.normal();
            points.push_back({{r * std::cos(a), r * std::sin(a), size * h}, {}});
        }
        const TemporaryFolder folder;
        const DetectReport report = detect_primitives(build_surface_tree(folder.path(), points), {});
        const auto is_round = [](const Primitive& one) { return !traits_of(one.fit.shape.kind).is_flat(); };
        EXPECT_EQ(std::count_if(report.primitives.begin(), report.primitives.end(), is_round), 0) << size;
        const auto is_of_cones = [](const std::string& note) { return note.find("cones") != std::string::npos; };
        EXPECT_EQ(std::count_if(report.notes.begin(), report.notes.end(), is_of_cones), 1) << size;
    }
}

}  // namespace
