// Planes that are one level of a depth camera, and exact planes that are not.
#include "pcm/place/depth_levels.h"

#include "pcm/place/fit_at.h"
#include "tests/place/shape_cloud.h"

#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double pixel = 0.01, depth_step = 0.03;

pcm::Shape level_plane(const Vec3d& point, const Vec3d& normal)
{
    pcm::Shape plane;
    plane.kind = ShapeKind::plane;
    plane.point = point;
    plane.axis = normal;
    return plane;
}

// What is seen from above, a point for each pixel across z: heights in metres.
std::vector<SurfacePoint> depth_image(const std::function<double(double, double)>& height, int size = 160)
{
    std::vector<SurfacePoint> points;
    for (int i = 0; i < size; ++i)
        for (int k = 0; k < size; ++k) points.push_back({{pixel * i, pixel * k, height(pixel * i, pixel * k)}, {}});
    return points;
}

double sloped(double x, double y) { return depth_step * std::floor((0.09 * x + 0.05 * y) / depth_step); }

FittedPrimitive level_clicked(const std::shared_ptr<PointCloud>& cloud, const Vec3d& place, double threshold = 0)
{
    FitAtOptions options;
    options.kinds = any_kind().kinds;
    options.fit.threshold = threshold;
    return fit_at(*cloud, {place}, {}, options);
}

class DepthLevels : public testing::Test {
protected:
    std::shared_ptr<PointCloud> cloud_of(const std::vector<SurfacePoint>& points)
    {
        build_surface_tree(folder_.path(), points);
        return PointCloud::open(folder_.path() / "surface.pct");
    }
    std::vector<double> levels_at(const std::shared_ptr<PointCloud>& cloud, const Vec3d& place, double noise = 0)
    {
        NearOptions near;
        near.count = 1000;
        near.places = true;
        return level_heights(points_near(*cloud, place, near), level_plane(place, {0, 0, 1}), noise);
    }

    TemporaryFolder folder_;
};

TEST_F(DepthLevels, AreDoubtedAndWithinTheErrors)
{
    const auto cloud = cloud_of(depth_image(sloped));
    for (const double x : {0.5, 0.8, 1.1}) {
        const Vec3d place{x, 0.7, sloped(x, 0.7)};
        const ShapeFit fit = level_clicked(cloud, place).primitive.fit;
        ASSERT_LT(fit.noise, 1e-6);
        EXPECT_EQ(fit.verdict, FitVerdict::doubtful);
        EXPECT_NE(fit.message.find("parallel levels 0.03 apart"), std::string::npos) << fit.message;
        EXPECT_NEAR(fit.errors.position, depth_step / std::sqrt(12.0), 1e-6);
        // The surface has a slope of 0.1 to the level.
        EXPECT_GT(fit.errors.angle, 0.1 / 3);
        EXPECT_LT(fit.errors.angle, 0.1);
    }
    // Several levels are the surface.
    const ShapeFit whole = level_clicked(cloud, {0.8, 0.7, sloped(0.8, 0.7)}, 0.06).primitive.fit;
    EXPECT_EQ(whole.message.find("levels"), std::string::npos) << whole.message;
    EXPECT_LT(length(cross(whole.shape.axis, normalised(Vec3d{-0.09, -0.05, 1}))), 0.01);
}

// Turned with its cloud, and rounded to a tenth of a millimetre.
TEST_F(DepthLevels, OfATurnedCloud)
{
    std::vector<SurfacePoint> points = depth_image(sloped);
    const Vec3d u = normalised(Vec3d{1, 0.3, -0.2}), w = normalised(cross(u, {0.1, 1, 0.4})), v = cross(w, u);
    const auto turned = [&](const Vec3d& p) { return p[0] * u + p[1] * v + p[2] * w; };
    for (SurfacePoint& p : points) {
        p.position = turned(p.position);
        for (double& c : p.position) c = 1e-4 * std::round(1e4 * c);
    }
    const auto cloud = cloud_of(points);
    const ShapeFit fit = level_clicked(cloud, turned({0.8, 0.7, sloped(0.8, 0.7)})).primitive.fit;
    ASSERT_LT(fit.noise, 1e-4);
    EXPECT_EQ(fit.verdict, FitVerdict::doubtful);
    EXPECT_GT(fit.errors.position, 0.95 * depth_step / std::sqrt(12.0));
}

// A box whose sides are rows of points, one above the other.
TEST_F(DepthLevels, NotABoxWithoutNoise)
{
    std::vector<SurfacePoint> points;
    for (int i = 0; i <= 40; ++i)
        for (int k = 0; k <= 40; ++k)
            for (const int height : {0, 40}) {
                points.push_back({{pixel * i, pixel * k, pixel * height}, {}});
                if (i % 40 != 0) points.push_back({{pixel * i, pixel * height, pixel * k}, {}});
                points.push_back({{pixel * height, pixel * i, pixel * k}, {}});
            }
    const auto cloud = cloud_of(points);
    EXPECT_TRUE(levels_at(cloud, {0.02, 0.2, 0.4}).empty());
    EXPECT_EQ(level_clicked(cloud, {0.2, 0.2, 0.4}).primitive.fit.verdict, FitVerdict::good);
}

TEST_F(DepthLevels, NotTheTwoFacesOfAPlate)
{
    std::vector<SurfacePoint> points = depth_image([](double, double) { return 0.0; }, 60);
    for (const SurfacePoint& p : depth_image([](double, double) { return 0.05; }, 60)) points.push_back(p);
    const auto cloud = cloud_of(points);
    EXPECT_EQ(levels_at(cloud, {0.3, 0.3, 0}).size(), 2u);
    EXPECT_EQ(level_clicked(cloud, {0.3, 0.3, 0}).primitive.fit.verdict, FitVerdict::good);
    // A third one makes them levels.
    for (const SurfacePoint& p : depth_image([](double, double) { return 0.11; }, 60)) points.push_back(p);
    const auto three = cloud_of(points);
    const std::vector<double> levels = levels_at(three, {0.3, 0.3, 0});
    ASSERT_EQ(levels.size(), 3u);
    EXPECT_NEAR(levels[1], 0.05, 1e-6);
    EXPECT_NEAR(levels[2], 0.11, 1e-6);
    EXPECT_EQ(level_clicked(three, {0.3, 0.3, 0}).primitive.fit.verdict, FitVerdict::doubtful);
}

// A floor with some steps in one corner of it, whose risers are not seen.
TEST_F(DepthLevels, NotAFloorWithStepsInOneCorner)
{
    const auto cloud = cloud_of(depth_image([](double x, double y) {
        const double corner = std::max(x, y);
        return corner < 0.1 ? 0.1 : corner < 0.2 ? 0.05 : 0.0;
    }));
    EXPECT_EQ(levels_at(cloud, {0.2, 0.05, 0}).size(), 3u);
    EXPECT_EQ(level_clicked(cloud, {0.8, 0.8, 0}).primitive.fit.verdict, FitVerdict::good);
}

TEST_F(DepthLevels, NotARoughSurfaceNextToAPlane)
{
    Dice dice(5);
    const auto cloud =
        cloud_of(depth_image([&](double x, double) { return x < 0.81 ? 0.0 : 0.2 + 0.03 * dice.unit(); }));
    EXPECT_TRUE(levels_at(cloud, {0.8, 0.8, 0}, 0.002).empty());
}

// One that all others are left out around says nothing of them.
TEST_F(DepthLevels, OnlyAmongChosenPoints)
{
    const auto cloud = cloud_of(depth_image(sloped));
    const double height = sloped(0.8, 0.7);
    const FittedPrimitive found = level_clicked(cloud, {0.8, 0.7, height});
    ASSERT_EQ(found.primitive.fit.verdict, FitVerdict::doubtful);
    Primitive again = found.primitive;
    again.fit.verdict = FitVerdict::good;
    Selection limit;
    limit.box = Box3d{{-1, -1, height - 0.01}, {3, 3, height + 0.01}};
    doubt_level(*cloud, limit, again);
    EXPECT_EQ(again.fit.verdict, FitVerdict::good);
    doubt_level(*cloud, {}, again);
    EXPECT_EQ(again.fit.verdict, FitVerdict::doubtful);
}

// Stairs, whose risers are seen.
TEST_F(DepthLevels, NotStairsNorNoise)
{
    std::vector<SurfacePoint> points;
    Dice dice(4);
    for (int i = 0; i < 6000; ++i) {
        const double x = dice.between(0, 1.2), y = dice.between(0, 1.2), tread = std::floor(x / 0.12);
        points.push_back({{x, y, 0.06 * tread}, {}});
        if (i % 2) points.push_back({{0.12 * tread, y, 0.06 * (tread - dice.unit())}, {}});
    }
    const auto cloud = cloud_of(points);
    EXPECT_TRUE(levels_at(cloud, {0.66, 0.6, 0.3}).empty());
    // Nor has the plane of a place between two levels any of them.
    const auto levels = cloud_of(depth_image(sloped));
    const Vec3d place{0.8, 0.7, sloped(0.8, 0.7)};
    EXPECT_FALSE(levels_at(levels, place).empty());
    EXPECT_TRUE(levels_at(levels, place + Vec3d{0, 0, 0.01}).empty());
    EXPECT_TRUE(levels_at(levels, place, 0.02).empty());
}

TEST_F(DepthLevels, OfRealDepthCameras)
{
    const std::vector<std::pair<const char*, Vec3d>> places{
        {"pcd/office1.pcd", {-1.0048800706863403, -0.35075992345809937, 4.9770002365112305}},
        {"derived/kinect_2block_rgb.ptx", {-1.34666, -0.48095, 5.05}}};
    for (const auto& [name, place] : places) {
        PCM_REQUIRE_SAMPLE(name);
        TemporaryFolder folder;
        build_tree({sample(name)}, folder / "cloud.pct", {});
        const ShapeFit fit = level_clicked(PointCloud::open(folder / "cloud.pct"), place).primitive.fit;
        ASSERT_EQ(fit.noise, 0) << name;
        EXPECT_EQ(fit.verdict, FitVerdict::doubtful) << name;
        EXPECT_NE(fit.message.find("as a depth camera records"), std::string::npos) << name << ": " << fit.message;
        EXPECT_GT(fit.errors.position, 0.01) << name;
    }
}

}  // namespace
