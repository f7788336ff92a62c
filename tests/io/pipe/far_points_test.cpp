#include "pcm/io/pipe/far_points.h"

#include "pcm/bpc/byte_order.h"
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

// Points that several watch, one part each, the last of which are far away.
TEST(FarPoints, ThePartsOfACloudFindWhatOneFinds)
{
    std::mt19937_64 random(7);
    unsigned found = 0;
    for (int round = 0; round < 60; ++round) {
        std::vector<Vec3d> points = scattered({0, 0, 0}, 100, 300 + random() % 700, random());
        const std::size_t far = random() % 40;
        for (std::size_t i = 0; i < far; ++i) {
            const double where = round % 2 ? 3.4e38 : 3.4e38 / static_cast<double>(1 + i);
            points[random() % points.size()] = Vec3d{where, -where, round % 3 ? where : 0.5};
        }
        FarPoints merged, one;
        for (std::size_t i = 0; i < points.size();) {
            FarPoints part;
            for (std::size_t n = random() % 300; n > 0 && i < points.size(); --n) part.watch(points[i++]);
            ByteWriter saved;
            part.save(saved);
            ByteReader in(saved.bytes().data(), saved.size(), {});
            merged.merge(FarPoints::load(in));
            EXPECT_EQ(in.left(), 0u);
        }
        for (const Vec3d& p : points) one.watch(p);
        EXPECT_EQ(merged.points(), one.points());
        EXPECT_EQ(merged.box(), one.box());
        EXPECT_EQ(merged.usual_magnitude(), one.usual_magnitude());
        const auto mine = merged.find(steps), expected = one.find(steps);
        ASSERT_EQ(mine.has_value(), expected.has_value());
        if (!mine) continue;
        ++found;
        EXPECT_EQ(mine->points, expected->points);
        EXPECT_EQ(mine->first, expected->first);
        EXPECT_EQ(mine->step, expected->step);
        EXPECT_EQ(mine->spacing, expected->spacing);
        EXPECT_EQ(mine->limit, expected->limit);
    }
    EXPECT_GT(found, 20u);
    EXPECT_LT(found, 60u);
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
    // A model around the origin together with map coordinates, and a scan whose points get denser towards it.
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

// Each point counts by its own coordinates, whichever was watched before it; around 1, too.
TEST(FarPoints, TheOrderOfPointsDoesNotMatter)
{
    std::vector<Vec3d> points = scattered({1.5, 1.5, 1.5}, 0.4, 2000), odd = scattered({0, 0, 1e20}, 1, 700, 3);
    for (const bool mixed : {false, true}) {
        std::vector<Vec3d> all;
        for (std::size_t i = 0; i < points.size(); ++i) {
            all.push_back(points[i]);
            if (mixed && i < odd.size()) all.push_back(odd[i]);
        }
        if (!mixed) all.insert(all.end(), odd.begin(), odd.end());
        const auto found = find(all);
        ASSERT_TRUE(found);
        EXPECT_EQ(found->points, odd.size());
        EXPECT_EQ(found->first, odd[0]);
        EXPECT_EQ(found->limit, 10);
        FarPoints far;
        for (const Vec3d& p : all) far.watch(p);
        EXPECT_EQ(far.usual_magnitude(), 2);
    }
}

// The limit lies between the two, be it a round number or not. Steps of a grid of 100 cells.
TEST(FarPoints, TheLimitLeavesOutAllFarPoints)
{
    const auto coarse = [](const Box3d& box) {
        Vec3d step{};
        for (std::size_t a = 0; a < 3; ++a) step[a] = std::max(std::fabs(box.min[a]), std::fabs(box.max[a])) / 100;
        return step;
    };
    std::vector<Vec3d> cloud = scattered({0, 0, 0}, 130, 1000);
    cloud.push_back({130, 0, 0});
    for (const auto& [nearest, limit] : {std::pair{600.0, 130.0}, {1010.0, 1000.0}}) {
        FarPoints far;
        for (const Vec3d& p : cloud) far.watch(p);
        for (int i = 0; i < 10; ++i) far.watch(Vec3d{nearest + (i * 7) % 10, 0, 0});
        const auto found = far.find(coarse);
        ASSERT_TRUE(found);
        EXPECT_EQ(found->points, 10u);
        EXPECT_EQ(found->limit, limit);
    }
}

// Places differ by 64ths of the power of two below them: sixteen are few.
TEST(FarPoints, FewPlacesAreFarWhateverTheNumberOfTheirPoints)
{
    const std::vector<Vec3d> cloud = scattered({50, 50, 5}, 40, 500);
    const auto at_places = [](int places, double step) {
        std::vector<Vec3d> odd;
        for (int k = 0; k < 40 * places; ++k) odd.push_back({0, std::ldexp(1 + step * (k % places), 100), 0});
        return odd;
    };
    for (const int places : {1, 15, 16}) {
        const auto found = find(cloud + at_places(places, 1.0 / 64));
        ASSERT_TRUE(found) << places;
        EXPECT_EQ(found->points, 40u * static_cast<unsigned>(places));
    }
    // As many far points as that at more places are the cloud, for all that is known.
    EXPECT_FALSE(find(cloud + at_places(17, 1.0 / 64)));
    // Places nearer to each other are one: 31 of them are 16.
    const auto near = find(cloud + at_places(31, 1.0 / 128));
    ASSERT_TRUE(near);
    EXPECT_EQ(near->points, 1240u);
    EXPECT_FALSE(find(cloud + at_places(33, 1.0 / 128)));
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
