// Detection where stations of a scanner are apart: plates whose faces they see, and planes that they leave in layers.
#include "pcm/detect/detect.h"

#include "tests/detect/checked_labels.h"
#include "tests/place/station_cloud.h"

#include <algorithm>

namespace {

using namespace pcm;
using namespace pcm::test;

// A floor and walls that four stations see.
class PlateFaces : public testing::Test {
protected:
    void place_stations(const std::array<Vec3d, 4>& shifts)
    {
        shifts_ = shifts;
        for (int i = 0; i < 60000; ++i) {
            const double a = dice_.between(-4, 4), b = dice_.between(0, 2.5);
            if (i % 3 == 0) put({a, dice_.between(-4, 4), 0}, {0, 0, 1}, i % 4);
            if (i % 3 == 1) put({a, 4, b}, {0, -1, 0}, i % 4);
            if (i % 3 == 2) put({4, a, b}, {-1, 0, 0}, i % 4);
        }
    }
    void place_stations(double spread)
    {
        std::array<Vec3d, 4> shifts;
        for (Vec3d& shift : shifts) shift = {spread * dice_.normal(), spread * dice_.normal(), spread * dice_.normal()};
        place_stations(shifts);
    }
    void put(const Vec3d& p, const Vec3d& n, int station)
    {
        points_.push_back(
            {hall + p + scan_noise * dice_.normal() * n + shifts_.at(static_cast<std::size_t>(station)), station});
    }
    // A web across y = 0, of which stations 0 and 1 see one face, 2 and 3 the other.
    void add_web(double thickness, double from, double to, std::size_t count = 4000)
    {
        for (std::size_t i = 0; i < count; ++i) {
            const int station = static_cast<int>(i % 4);
            const double side = station < 2 ? 1 : -1;
            put({dice_.between(from, to), side * thickness / 2, dice_.between(1, 1.2)}, {0, side, 0}, station);
        }
    }
    // Planes next to y = 0, or z = 1, with most points first.
    std::vector<Primitive> found(std::size_t axis, double height, Says says = Says::source_id)
    {
        write_stations_ply(folder_ / "hall.ply", points_, says);
        BuildOptions options;
        options.chunk_points = 8000;
        options.overwrite = true;
        build_tree({folder_ / "hall.ply"}, folder_ / "hall.pct", options);
        const auto tree = Tree::open(folder_ / "hall.pct");
        DetectOptions detect;
        detect.threads = 1;
        const DetectReport report = detect_primitives(tree, detect);
        check_labels(*tree, report);
        std::vector<Primitive> planes;
        for (const Primitive& one : report.primitives)
            if (one.fit.shape.kind == ShapeKind::plane && std::fabs(one.fit.shape.axis[axis]) > 0.99 &&
                std::fabs(one.fit.shape.point[axis] - hall[axis] - height) < 0.1)
                planes.push_back(one);
        return planes;
    }
    static double off(const Primitive& one, const Vec3d& p)
    {
        return std::fabs(signed_distance(one.fit.shape, hall + p)) / one.fit.errors.position;
    }

    Dice dice_{31};
    std::array<Vec3d, 4> shifts_{};
    std::vector<StationPoint> points_;
    TemporaryFolder folder_;
};

TEST_F(PlateFaces, BothFacesOfAWebAreFoundThatIsThinnerThanTheThreshold)
{
    for (const double thickness : {0.007, 0.01}) {
        points_.clear();
        place_stations(0.0015);
        add_web(thickness, -3, 3);
        std::vector<Primitive> faces = found(1, 0);
        ASSERT_EQ(faces.size(), 2u) << thickness;
        std::sort(faces.begin(), faces.end(),
                  [](const Primitive& a, const Primitive& b) { return a.fit.shape.point[1] < b.fit.shape.point[1]; });
        for (const std::size_t k : {0, 1}) {
            const double y = (k == 0 ? -0.5 : 0.5) * thickness;
            EXPECT_EQ(faces[k].fit.verdict, FitVerdict::good);
            EXPECT_GT(faces[k].points, 1900u);
            EXPECT_LT(faces[k].points, 2005u);
            EXPECT_LT(off(faces[k], {0, y, 1.1}), 3) << thickness << " " << k;
        }
    }
}

// What two posts divide is in three plates before their faces are joined.
TEST_F(PlateFaces, FacesOfAWebBehindPostsAreTwo)
{
    place_stations(0.0015);
    for (const double x : {-3.0, -0.8, 1.4}) add_web(0.008, x, x + 1.9, 2400);
    const std::vector<Primitive> faces = found(1, 0);
    ASSERT_EQ(faces.size(), 2u);
    for (const Primitive& face : faces) EXPECT_GT(face.points, 3400u);
}

// A narrow flange that two stations see, whose heights are 4.5 mm apart as on the floor, most of which others see.
TEST_F(PlateFaces, LayersOfStationsAreOnePlane)
{
    place_stations({Vec3d{0.003, -0.0035, 0.0045}, Vec3d{}, Vec3d{}, Vec3d{}});
    for (int i = 0; i < 10000; ++i) put({dice_.between(-4, 4), dice_.between(-4, 4), 0}, {0, 0, 1}, 2 + i % 2);
    for (int i = 0; i < 3000; ++i) put({dice_.between(-3, 3), dice_.between(0, 0.15), 1}, {0, 0, 1}, i % 2);
    const std::vector<Primitive> flange = found(2, 1);
    ASSERT_EQ(flange.size(), 1u);
    EXPECT_EQ(flange[0].fit.verdict, FitVerdict::good) << flange[0].fit.message << " " << flange[0].fit.noise;
    EXPECT_GT(flange[0].points, 2800u);
}

// A rough strip that stations see 3.2 mm apart: two planes would have hardly less noise.
TEST_F(PlateFaces, ARoughStripIsOnePlane)
{
    place_stations(0.0);
    for (int i = 0; i < 4000; ++i) {
        const int station = i % 4;
        const double rough = 0.0028 * dice_.normal() + (station < 2 ? 0.0016 : -0.0016);
        put({dice_.between(-3, 3), dice_.between(0, 0.15), 1 + rough}, {0, 0, 1}, station);
    }
    const std::vector<Primitive> strip = found(2, 1);
    ASSERT_EQ(strip.size(), 1u);
    EXPECT_GT(strip[0].points, 3600u);
}

// The middle of a web between posts is seen by another station than its ends.
TEST_F(PlateFaces, PartsThatStationsShiftAreJoined)
{
    place_stations({Vec3d{0.002, 0.0025, -0.002}, Vec3d{-0.002, -0.0025, 0.002}, Vec3d{}, Vec3d{}});
    for (int i = 0; i < 4500; ++i) {
        const double x = dice_.between(-0.8, 0.8), z = dice_.between(1, 1.3);
        put({x + 2 * (i % 3 - 1), 0, z}, {0, 1, 0}, i % 3 == 1);
    }
    const std::vector<Primitive> web = found(1, 0);
    ASSERT_EQ(web.size(), 1u);
    EXPECT_GT(web[0].points, 4200u);
}

}  // namespace
