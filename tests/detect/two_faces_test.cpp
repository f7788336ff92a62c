// Two faces of a plate by the stations that see them.
#include "pcm/detect/two_faces.h"

#include "tests/place/shape_cloud.h"

namespace {

using namespace pcm;
using namespace pcm::test;

constexpr double face_noise = 0.0015, left_over = 0.0005;

class TwoFacesTest : public testing::Test {
protected:
    // Points of z = height + 0.01 x in a strip.
    void add(std::uint32_t station, double height, std::size_t count = 200)
    {
        for (std::size_t i = 0; i < count; ++i) {
            const double x = dice_.between(0, 3);
            points_.push_back(
                {origin + Vec3d{x, dice_.between(0, 0.2), height + 0.01 * x + face_noise * dice_.normal()}, station});
        }
    }
    std::optional<TwoFaces> faces() const
    {
        pcm::Shape plane;
        plane.point = origin;
        return two_faces(plane, points_, left_over);
    }

    static constexpr Vec3d origin{454321, 5412345, 310};
    Dice dice_{4};
    std::vector<PointOfStation> points_;
};

TEST_F(TwoFacesTest, StationsOnBothSidesAreDivided)
{
    add(3, 0);
    add(8, 0.0075, 300);
    add(5, 0.0005);
    add(9, 0.0068, 100);
    const auto found = faces();
    ASSERT_TRUE(found);
    EXPECT_EQ(found->face_of.size(), 4u);
    EXPECT_EQ(found->face_of.at(3), found->face_of.at(5));
    EXPECT_EQ(found->face_of.at(8), found->face_of.at(9));
    EXPECT_NE(found->face_of.at(3), found->face_of.at(8));
    EXPECT_NEAR(found->apart, 0.007, 0.0006);
    EXPECT_NEAR(found->certainty, found->apart / left_over, 1e-9) << "two stations a side";
    EXPECT_NEAR(found->noise, face_noise, 0.0002);
    EXPECT_NEAR(found->noise_as_one, std::hypot(face_noise, 0.0035), 0.0005);
    const double up = found->planes[found->face_of.at(8)].axis[2] > 0 ? 1 : -1;
    for (const double x : {0.0, 3.0}) {
        const Vec3d p = origin + Vec3d{x, 0.1, 0.01 * x};
        EXPECT_NEAR(up * signed_distance(found->planes[found->face_of.at(3)], p), -0.00025, 0.0004);
        EXPECT_NEAR(up * signed_distance(found->planes[found->face_of.at(8)], p), -0.0073, 0.0004);
    }
}

TEST_F(TwoFacesTest, FewerStationsOnASideAreLessCertain)
{
    for (std::uint32_t station = 0; station < 3; ++station) add(station, 0);
    add(7, 0.007);
    const auto found = faces();
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->certainty, found->apart / (left_over * std::sqrt(1 + 1.0 / 3)), 1e-9);
}

// The mean of a station that sees one end of a tilted plate is on the other side of the others.
TEST_F(TwoFacesTest, AStationIsGivenToTheFaceThatItsPointsLieOn)
{
    for (std::uint32_t station = 0; station < 4; ++station) add(station, station < 2 ? 0 : 0.006);
    for (std::size_t i = 0; i < 100; ++i)
        points_.push_back({origin + Vec3d{dice_.between(2.8, 3), dice_.between(0, 0.2), 0.029}, 9});
    const auto found = faces();
    ASSERT_TRUE(found);
    EXPECT_EQ(found->face_of.at(9), found->face_of.at(0));
    EXPECT_NE(found->face_of.at(9), found->face_of.at(2));
}

// Two divisions that no station leaves; that of the least distances is the better one.
TEST_F(TwoFacesTest, TheBestDivisionIsTaken)
{
    add(1, 0);
    add(2, 0.005);
    add(3, 0.012, 10);
    const auto found = faces();
    ASSERT_TRUE(found);
    EXPECT_NE(found->face_of.at(1), found->face_of.at(2));
    EXPECT_EQ(found->face_of.at(2), found->face_of.at(3));
}

TEST_F(TwoFacesTest, StationsThatAreNearlyTogetherAreNotFarApart)
{
    for (std::uint32_t station = 0; station < 6; ++station) add(station, left_over * dice_.normal());
    const auto found = faces();
    ASSERT_TRUE(found);
    EXPECT_LT(found->certainty, 4.5);
    EXPECT_GT(found->noise, 0.9 * found->noise_as_one);
}

TEST_F(TwoFacesTest, OneStationOrPointsOnALineShowNone)
{
    EXPECT_FALSE(faces());
    add(1, 0);
    EXPECT_FALSE(faces());
    points_.clear();
    for (int i = 0; i < 50; ++i) points_.push_back({origin + Vec3d{0.1 * i, 0, 0}, static_cast<std::uint32_t>(i % 2)});
    EXPECT_FALSE(faces());
}

}  // namespace
