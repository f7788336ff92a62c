// The face of a plate at a place, where most of the nearest points lie on the other one.
#include "pcm/place/face_at_place.h"

#include "pcm/place/fit_at.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <cmath>
#include <memory>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double face_noise = 0.0013;
constexpr Vec3d face_middle{456780, 5432100, 120};

pcm::Shape face_at(double height)
{
    pcm::Shape plane;
    plane.point = face_middle + Vec3d{0, 0, height};
    plane.axis = {0, 0, 1};
    return plane;
}

// Faces of 0.6 m; the upper one, at height 0, has a third of the points of the lower one.
std::vector<SurfacePoint> two_faces(double thickness, Dice& dice)
{
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 4000; ++i) points.push_back(point_on(face_at(0), 0.3, 0, face_noise, dice));
    for (int i = 0; i < 12000; ++i) points.push_back(point_on(face_at(-thickness), 0.3, 0, face_noise, dice));
    return points;
}

class FaceAtPlace : public testing::Test {
protected:
    void build(const std::vector<SurfacePoint>& points)
    {
        build_surface_tree(folder_.path(), points);
        cloud_ = PointCloud::open(folder_ / "surface.pct");
    }
    Dice dice_{4};
    TemporaryFolder folder_;
    std::shared_ptr<PointCloud> cloud_;
};

TEST_F(FaceAtPlace, IsThePickedOneOfBoth)
{
    for (const double thickness : {0.009, 0.016}) {
        build(two_faces(thickness, dice_));
        const auto local = fit_face(*cloud_, face_middle, any_kind());
        ASSERT_TRUE(local) << thickness;
        EXPECT_EQ(local->fit.verdict, FitVerdict::good);
        EXPECT_LT(distance_to(local->fit.shape, face_middle), 0.0005) << thickness;
        EXPECT_NEAR(local->fit.noise, face_noise, 0.25 * face_noise);
        EXPECT_LT(local->fit.threshold, thickness / 2 + 1e-9);
        EXPECT_GT(local->near.ids.size(), 80u);
        ASSERT_FALSE(local->notes.empty());
    }
}

// The whole way, from places all over the sparse face.
TEST_F(FaceAtPlace, PCM_NOT_UNDER_SANITIZERS(IsFollowedOverThePlate))
{
    const std::vector<SurfacePoint> points = two_faces(0.009, dice_);
    build(points);
    FitAtOptions options;
    options.kinds = any_kind().kinds;
    for (const std::size_t i : {0, 1, 2, 3}) {
        const FittedPrimitive fitted = fit_at(*cloud_, {points[i].position}, {}, options);
        const ShapeFit& fit = fitted.primitive.fit;
        EXPECT_EQ(fit.verdict, FitVerdict::good) << fit.message;
        EXPECT_EQ(fit.shape.kind, ShapeKind::plane);
        EXPECT_LT(distance_to(fit.shape, face_middle), 4 * fit.errors.position + 1e-4);
        EXPECT_GT(fitted.points.size(), 3600u);
        EXPECT_LT(fitted.points.size(), 4700u) << "points of the other face";
    }
}

TEST_F(FaceAtPlace, OneFaceAndPipesHaveNoOther)
{
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 8000; ++i) points.push_back(point_on(face_at(0), 0.3, 0, face_noise, dice_));
    build(points);
    EXPECT_FALSE(fit_face(*cloud_, face_middle, any_kind()));

    pcm::Shape pipe = face_at(0);
    pipe.kind = ShapeKind::cylinder;
    pipe.radius = 0.02;
    points.clear();
    for (int i = 0; i < 8000; ++i) points.push_back(point_on(pipe, 0.6, 2 * pi, face_noise, dice_));
    build(points);
    for (const int i : {3, 500, 1000})
        EXPECT_FALSE(fit_face(*cloud_, points[static_cast<std::size_t>(i)].position, any_kind()));
}

// Points between the faces are those of something else.
TEST_F(FaceAtPlace, NotAmongOthers)
{
    std::vector<SurfacePoint> points = two_faces(0.016, dice_);
    for (int i = 0; i < 40000; ++i) {
        SurfacePoint p = point_on(face_at(0), 0.3, 0, 0, dice_);
        p.position = p.position + Vec3d{0, 0, dice_.between(-0.05, 0.03)};
        points.push_back(p);
    }
    build(points);
    EXPECT_FALSE(fit_face(*cloud_, face_middle, any_kind()));
}

struct Layer {
    double height;
    int points;
};

std::vector<SurfacePoint> layers_of(const std::vector<Layer>& layers, Dice& dice)
{
    std::vector<SurfacePoint> points;
    for (const Layer& layer : layers)
        for (int i = 0; i < layer.points; ++i)
            points.push_back(point_on(face_at(layer.height), 0.3, 0, face_noise, dice));
    return points;
}

// A third face: a sixth of the points may be on it, two fifths may not.
TEST_F(FaceAtPlace, IsFoundWithFewPointsOnNeitherFaceAndNotWithMany)
{
    build(layers_of({{0, 3000}, {-0.016, 10000}, {0.02, 2300}}, dice_));
    EXPECT_TRUE(fit_face(*cloud_, face_middle, any_kind()));
    build(layers_of({{0, 3000}, {-0.016, 6500}, {0.02, 6000}}, dice_));
    EXPECT_FALSE(fit_face(*cloud_, face_middle, any_kind()));
}

// A tenth of the nearest points is the least.
TEST_F(FaceAtPlace, HasAShareOfThePoints)
{
    build(layers_of({{0, 2000}, {-0.016, 14000}}, dice_));
    EXPECT_TRUE(fit_face(*cloud_, face_middle, any_kind()));
    build(layers_of({{0, 1100}, {-0.016, 15000}}, dice_));
    EXPECT_FALSE(fit_face(*cloud_, face_middle, any_kind()));
}

// Faces nearer to each other than 1.2 thresholds are one.
TEST_F(FaceAtPlace, IsFartherThanTheNoise)
{
    for (const double thickness : {0.002, 0.003}) {
        build(two_faces(thickness, dice_));
        EXPECT_FALSE(fit_face(*cloud_, face_middle, any_kind())) << thickness;
    }
}

TEST_F(FaceAtPlace, WhatIsGivenIsTaken)
{
    build(two_faces(0.016, dice_));
    LocalFitOptions options = any_kind();
    options.fit.threshold = 0.003;
    EXPECT_FALSE(fit_face(*cloud_, face_middle, options));
    options = any_kind();
    options.count = 300;
    EXPECT_FALSE(fit_face(*cloud_, face_middle, options));
    options = any_kind();
    options.kinds = {ShapeKind::cylinder, ShapeKind::sphere};
    EXPECT_FALSE(fit_face(*cloud_, face_middle, options));
}

}  // namespace
