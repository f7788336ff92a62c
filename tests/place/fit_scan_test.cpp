// From picked places to primitives on scans of real things.
#include "pcm/place/fit_at.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "tests/place/shape_cloud.h"
#include "tests/sanitizers.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace {

using namespace pcm;
using namespace pcm::test;

// Scans of real things, against what their owners or others published of them (GROUND_TRUTH.csv); nothing but a place
// is given unless stated otherwise.
class FitScan : public testing::Test {
protected:
    std::shared_ptr<PointCloud> open(const std::string& name)
    {
        build_tree({sample(name)}, folder_ / "scan.pct", {});
        return PointCloud::open(folder_ / "scan.pct");
    }
    static FittedPrimitive fit(const PointCloud& cloud, ShapeKind kind, const Vec3d& place, double threshold = 0)
    {
        FitAtOptions options;
        options.fit.kind = kind;
        options.fit.threshold = threshold;
        return fit_at(cloud, {place}, {}, options);
    }
    static Vec3d line(const std::string& name, int number)
    {
        std::ifstream file(sample(name));
        std::string text;
        for (int i = 0; i <= number; ++i) std::getline(file, text);
        std::istringstream words(text);
        Vec3d p{};
        words >> p[0] >> p[1] >> p[2];
        return p;
    }
    TemporaryFolder folder_;
};

// Not under the thread sanitizer: many fits, whose threads other tests watch.
TEST_F(FitScan, PCM_NOT_UNDER_THREAD(MugAndTable))
{
    const std::string name = "primitives/table_scene_mug_stereo_textured.pcd";
    PCM_REQUIRE_SAMPLE(name);
    const auto cloud = open(name);
    for (const Vec3d& place : {Vec3d{0.063, 0.078, 0.735}, Vec3d{0.05, 0.08, 0.73}, Vec3d{0.03, 0.06, 0.735}}) {
        const FittedPrimitive mug = fit(*cloud, ShapeKind::cylinder, place);
        ASSERT_TRUE(mug.primitive.fit.has_shape());
        EXPECT_NEAR(mug.primitive.fit.shape.radius, 0.0396, 0.001);
        EXPECT_GT(mug.points.size(), 9000u);
        EXPECT_FALSE(mug.notes.empty());  // neighbours agree
    }
    const FittedPrimitive table = fit(*cloud, ShapeKind::plane, {0.2, 0, 0.97});
    ASSERT_EQ(table.primitive.fit.verdict, FitVerdict::good);
    const Vec3d normal{-0.0161854, 0.837724, 0.545855};
    EXPECT_LT(length(cross(table.primitive.fit.shape.axis, normalised(normal))), 0.5 * pi / 180);
    const Shape published{ShapeKind::plane, 0.528787 / dot(normal, normal) * normal, normalised(normal), 0, 0};
    Vec3d middle{};
    for (const Vec3d& corner : table.primitive.bounds.outline) middle = middle + 0.25 * corner;
    EXPECT_LT(distance_to(published, middle), 0.002);
    EXPECT_GT(table.points.size(), 100000u);
}

TEST_F(FitScan, PCM_NOT_UNDER_THREAD(TangoScene))
{
    const std::string name = "primitives/curvsurf_tango_scene.xyz";
    PCM_REQUIRE_SAMPLE(name);
    const auto cloud = open(name);
    const FittedPrimitive cylinder = fit(*cloud, ShapeKind::cylinder, line(name, 3437));
    EXPECT_EQ(cylinder.primitive.fit.verdict, FitVerdict::good);
    EXPECT_NEAR(cylinder.primitive.fit.shape.radius, 0.0667, 0.0032);
    // The published radius is of all points within 10 mm, among them the table's. Ours leaves these out: it does not
    // depend on the threshold, while that of all points grows from 62 mm at 2 mm to 87 mm at 15 mm.
    double least = HUGE_VAL, largest = 0;
    for (const double threshold : {0.004, 0.007, 0.010, 0.015}) {
        const double radius = fit(*cloud, ShapeKind::cylinder, line(name, 3437), threshold).primitive.fit.shape.radius;
        least = std::min(least, radius);
        largest = std::max(largest, radius);
    }
    EXPECT_GT(least, 0.0642);
    EXPECT_LT(largest, 0.0652);
    EXPECT_LT(length(cross(cylinder.primitive.fit.shape.axis, normalised({-0.0255, 0.8618, 0.5066}))), 0.03);
    const FittedPrimitive sphere = fit(*cloud, ShapeKind::sphere, line(name, 7811), 0.005);  // as its truth
    const FittedPrimitive by_default = fit(*cloud, ShapeKind::sphere, line(name, 7811));
    for (const ShapeFit& ball : {sphere.primitive.fit, by_default.primitive.fit}) {
        EXPECT_EQ(ball.verdict, FitVerdict::good);
        EXPECT_GT(ball.shape.radius, 0.0785);
        EXPECT_LT(ball.shape.radius, 0.085);
        // The published centre has radii from 80.5 to 83 mm: it is not known more exactly.
        EXPECT_LT(length(ball.shape.point - Vec3d{0.100, -0.070, -0.968}), 0.0025);
    }
    const FittedPrimitive cone = fit(*cloud, ShapeKind::cone, line(name, 6637));
    EXPECT_TRUE(cone.primitive.fit.has_shape());
    EXPECT_GT(cone.points.size(), 250u);
    const FittedPrimitive torus = fit(*cloud, ShapeKind::torus, line(name, 7384));
    EXPECT_TRUE(torus.primitive.fit.has_shape());
    EXPECT_GT(torus.points.size(), 700u);
    RecordProperty("cone_half_angle_degrees", std::to_string(cone.primitive.fit.shape.second * 180 / pi));
    RecordProperty("torus_radius", std::to_string(torus.primitive.fit.shape.radius));
    RecordProperty("torus_tube", std::to_string(torus.primitive.fit.shape.second));
}

// A scan by a scanner that was carried: neighbours share errors, and noise differs from place to place. The ceiling
// hangs through by some millimetres, so that a cylinder of 250 m explains it better, but not what neighbours share. Of
// the wall the first threshold cuts the noise. Before, doubtful patches around the places.
TEST_F(FitScan, PCM_NOT_UNDER_SANITIZERS(CeilingAndWallOfAnIndoorScan))
{
    const std::string name = "las/indoor.laz";
    PCM_REQUIRE_SAMPLE(name);
    const auto cloud = open(name);
    FitAtOptions options;
    options.kinds = any_kind().kinds;
    const auto at = [&](const Vec3d& place) { return fit_at(*cloud, {place}, {}, options); };
    const FittedPrimitive ceiling = at({-7.07000, 5.03000, 2.59000}), wall = at({2.48000, -1.66000, 4.31000});
    for (const FittedPrimitive* plane : {&ceiling, &wall}) {
        EXPECT_EQ(plane->primitive.fit.verdict, FitVerdict::good) << plane->primitive.fit.message;
        EXPECT_EQ(plane->primitive.fit.shape.kind, ShapeKind::plane);
    }
    EXPECT_GT(ceiling.points.size(), 15000u);
    EXPECT_GT(wall.points.size(), 3300u);
}

// Labels of the file say how many points the table has (141,517), and which are on a box and on two equal cans.
// Under no sanitizer: minutes there, of what other tests run too.
TEST_F(FitScan, PCM_NOT_UNDER_SANITIZERS(TableBoxAndCans))
{
    const std::string name = "primitives/learn33.pcd";
    PCM_REQUIRE_SAMPLE(name);
    const auto cloud = open(name);
    FitAtOptions options;
    options.kinds = {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere};
    const auto at = [&](const Vec3d& place) { return fit_at(*cloud, {place}, {}, options); };
    const FittedPrimitive table = at({-0.1163, 0.0772, 0.9320});
    EXPECT_EQ(table.primitive.fit.shape.kind, ShapeKind::plane);
    EXPECT_EQ(table.primitive.fit.verdict, FitVerdict::good) << table.primitive.fit.message;
    EXPECT_GT(table.points.size(), 138000u);
    EXPECT_LT(table.points.size(), 143000u);
    const FittedPrimitive box = at({-0.1198, 0.1547, 0.7030});  // one of its faces, of 15,305 points in all
    EXPECT_EQ(box.primitive.fit.shape.kind, ShapeKind::plane);
    EXPECT_EQ(box.primitive.fit.verdict, FitVerdict::good) << box.primitive.fit.message;
    EXPECT_GT(box.points.size(), 10500u);
    EXPECT_LT(box.points.size(), 11500u);
    options.kinds = {ShapeKind::cylinder};
    // They stand on the table, and the camera smears their sides: whether they are certain is not.
    const FittedPrimitive can = at({0.1006, 0.1485, 0.7390}), other = at({0.2059, 0.0767, 0.8480});
    for (const ShapeFit& fit : {can.primitive.fit, other.primitive.fit}) {
        ASSERT_TRUE(fit.has_shape());
        EXPECT_EQ(fit.shape.kind, ShapeKind::cylinder);
        EXPECT_GT(std::fabs(dot(fit.shape.axis, table.primitive.fit.shape.axis)), 0.995);
    }
    EXPECT_NEAR(can.primitive.fit.shape.radius, other.primitive.fit.shape.radius, 0.0015);
}

Vec3d densest(const std::vector<Vec3d>& points)
{
    Vec3d best{};
    std::size_t most = 0;
    for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 200) {
        std::size_t near = 0;
        for (const Vec3d& p : points) near += length(p - points[i]) < 0.05;
        if (near > most) best = points[i];
        most = std::max(most, near);
    }
    return best;
}

TEST_F(FitScan, PCM_NOT_UNDER_THREAD(SixFacesOfTheCube))
{
    const std::string name = "primitives/cube.pwn";
    PCM_REQUIRE_SAMPLE(name);
    const auto cloud = open(name);
    // Its outer faces, and of each the one of some of the file's points on it that has the most of them around it.
    const Vec3d half{0.5, 0.371795, 0.371795};
    for (std::size_t a = 0; a < 3; ++a)
        for (const double side : {-1.0, 1.0}) {
            std::ifstream file(sample(name));
            std::vector<Vec3d> on_face;
            for (Vec3d p, n; file >> p[0] >> p[1] >> p[2] >> n[0] >> n[1] >> n[2];)
                if (std::fabs(p[a] - side * half[a]) < 1e-9) on_face.push_back(p);
            ASSERT_GT(on_face.size(), 500u);
            const FittedPrimitive face = fit(*cloud, ShapeKind::plane, densest(on_face));
            ASSERT_EQ(face.primitive.fit.verdict, FitVerdict::good) << face.primitive.fit.message;
            EXPECT_GT(std::fabs(face.primitive.fit.shape.axis[a]), 0.999999) << a << side;
            EXPECT_NEAR(face.primitive.fit.shape.point[a], side * half[a], 1e-6) << a << side;
        }
}

}  // namespace
