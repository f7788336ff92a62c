#include "pcm/io/pipe/far_points.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace {

using namespace pcm;

// A grid of 61 bits to each side of 0, as trees of floats have it.
Vec3d steps(const Box3d& box)
{
    Vec3d step;
    for (std::size_t a = 0; a < 3; ++a)
        step[a] = std::ldexp(std::max(std::fabs(box.min[a]), std::fabs(box.max[a])), -61);
    return step;
}

std::vector<Vec3d> scattered(const Vec3d& centre, double extent, std::size_t count, std::uint64_t seed = 1)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> within(-extent, extent);
    std::vector<Vec3d> points(count);
    for (Vec3d& p : points)
        for (std::size_t a = 0; a < 3; ++a) p[a] = centre[a] + within(random);
    return points;
}

std::optional<FarPoints::Finding> find(const std::vector<Vec3d>& points)
{
    FarPoints far;
    for (const Vec3d& p : points) far.watch(p);
    return far.find(steps);
}

std::vector<Vec3d> operator+(std::vector<Vec3d> points, const std::vector<Vec3d>& more)
{
    points.insert(points.end(), more.begin(), more.end());
    return points;
}

TEST(FarPoints, OrdinaryCloudsHaveNone)
{
    EXPECT_FALSE(find({}));
    EXPECT_FALSE(find({{0, 0, 0}}));
    EXPECT_FALSE(find(std::vector<Vec3d>(100, Vec3d{1, 2, 3})));
    for (const double extent : {1e-30, 1e-3, 1.0, 1e4, 1e30})
        EXPECT_FALSE(find(scattered({0, 0, 0}, extent, 5000))) << extent;
    EXPECT_FALSE(find(scattered({500000, 4800000, 100}, 100, 5000)));
    EXPECT_FALSE(find(scattered({500000, 4800000, 100}, 100, 5000) + std::vector<Vec3d>{{0, 0, 0}}));
    // A model around the origin beside map coordinates, and a scan whose points get denser towards it.
    EXPECT_FALSE(find(scattered({0, 0, 0}, 1, 5000) + scattered({5e5, 4.8e6, 0}, 100, 5000)));
    std::mt19937_64 random(2);
    std::vector<Vec3d> scan = scattered({0, 0, 0}, 1, 100000);
    for (Vec3d& p : scan)
        for (double& c : p) c *= std::pow(10.0, static_cast<double>(random() % 7) - 3);
    EXPECT_FALSE(find(scan));
    // Values such as -9999 are ordinary numbers.
    EXPECT_FALSE(find(scattered({0, 0, 0}, 100, 5000) + std::vector<Vec3d>(500, Vec3d{1, 2, -9999})));
}

TEST(FarPoints, RoundingErrorsAroundZeroAreNotTheCloud)
{
    for (const std::size_t odd : {100u, 3000u, 4999u})
        EXPECT_FALSE(find(scattered({0, 0, 0}, 1e-17, odd) + scattered({500, 300, 0}, 100, 5000))) << odd;
}

TEST(FarPoints, NoDataValuesAreFoundWhateverTheirNumber)
{
    const std::vector<Vec3d> cloud = scattered({50, 50, 5}, 40, 5000);
    for (const double value : {1e20, -1e30, 3.4028234663852886e38, 1e300, -std::numeric_limits<double>::max()})
        for (const std::size_t count : {1u, 250u, 20000u}) {
            std::vector<Vec3d> odd = scattered({50, 50, 0}, 40, count, 3);
            for (Vec3d& p : odd) p[2] = value;
            const auto found = find(cloud + odd);
            ASSERT_TRUE(found) << value << ", " << count;
            EXPECT_EQ(found->points, count);
            EXPECT_EQ(found->first, odd[0]);
            EXPECT_GE(found->limit, 90);
            EXPECT_LT(found->limit, 1e20);
            EXPECT_GT(found->step, found->spacing / 4);
        }
}

TEST(FarPoints, SeveralValuesAndGarbageAreFoundAtOnce)
{
    std::vector<Vec3d> odd = {{1e300, 0, 0}, {0, 1e30, 0}, {0, 0, -3.4e38}, {1e20, 1e20, 1e20}};
    const auto several = find(odd + scattered({0, 0, 0}, 10, 5000));
    ASSERT_TRUE(several);
    EXPECT_EQ(several->points, 4u);
    EXPECT_EQ(several->first, odd[0]);
    EXPECT_EQ(several->limit, 10);
    std::mt19937_64 random(4);
    std::vector<Vec3d> garbage(900);
    for (Vec3d& p : garbage)
        p = {std::ldexp(1.0, 70 + static_cast<int>(random() % 50)), 1.0,
             std::ldexp(1.5, static_cast<int>(random() % 90))};
    const auto found = find(scattered({0, 0, 0}, 10, 10000) + garbage);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->points, 900u);
}

TEST(FarPoints, TheRefusalHasNumberExampleAndWayOut)
{
    FarPoints far;
    for (const Vec3d& p : scattered({50, 50, 5}, 40, 5000)) far.watch(p);
    far.watch(Vec3d{50, 50, 3.4e38});
    far.watch(Vec3d{50, 51, 3.4e38});
    EXPECT_EQ(far.points(), 5002u);
    EXPECT_EQ(far.usual_magnitude(), 128);
    try {
        far.refuse(steps, "a grid");
        FAIL() << "nothing was refused";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        const std::string text = error.what();
        for (const char* part : {"2 of 5,002 points", "50 50 3.4e+38", "a grid", "--largest-coordinate 100"})
            EXPECT_NE(text.find(part), std::string::npos) << part << " is not in: " << text;
    }
}

TEST(FarPoints, PointsThatAreNotFiniteAreIgnored)
{
    PointBatch batch;
    batch.reset({}, false, 3);
    const double inf = std::numeric_limits<double>::infinity();
    batch.xyz[0] = {1, inf, 2};
    batch.xyz[1] = {1, 0, std::nan("")};
    batch.xyz[2] = {1, 0, 0};
    FarPoints far;
    far.watch(batch);
    EXPECT_EQ(far.points(), 1u);
    EXPECT_EQ(far.box().max, (Vec3d{1, 1, 1}));
}

}  // namespace
