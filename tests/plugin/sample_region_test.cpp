#include "plugin/scene/sample_region.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pcm::host {
namespace {

const Vec3d origin{500000, 4800000, 100};

// A square lattice of 100 x 100 points with a spacing of 1, on a gentle slope.
Proxy plane()
{
    Proxy sample;
    sample.spacing = 1;
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 100; ++x) {
            ProxyPoint point;
            point.position = {float(x), float(y), 0.01f * float(x)};
            sample.points.push_back(point);
        }
    return sample;
}

template <class Wanted>
std::vector<std::uint32_t> where(const Proxy& sample, const Wanted& wanted)
{
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t i = 0; i < sample.points.size(); ++i)
        if (wanted(sample.points[i].position)) chosen.push_back(i);
    return chosen;
}

void expect_exact(const Proxy& sample, const std::vector<std::uint32_t>& chosen, const Region& region)
{
    const auto inside = where(sample, [&](const std::array<float, 3>& p) {
        return region.contains(Vec3d{double(p[0]), double(p[1]), double(p[2])} + origin);
    });
    EXPECT_EQ(inside, chosen);
}

// From a point above the plane, straight down; turned by 30 degrees about the line of sight.
Matrix4d from_above()
{
    const double c = std::cos(pi / 6), s = std::sin(pi / 6), height = 120, f = 1.5;
    // Clip x = f (c (X - 50) - s (Y - 50)), y = f (s (X - 50) + c (Y - 50)), w = height - Z.
    Matrix4d m{};
    const auto row = [&](std::size_t r, double x, double y, double z, double one) {
        m[r] = x, m[4 + r] = y, m[8 + r] = z, m[12 + r] = one;
    };
    row(0, f * c, -f * s, 0, f * (-c * 50 + s * 50));
    row(1, f * s, f * c, 0, f * (-s * 50 - c * 50));
    row(2, 0, 0, -1, height - 2);
    row(3, 0, 0, -1, height);
    return m;
}

TEST(SampleRegion, IsABoxThatEndsHalfwayToTheOthers)
{
    const Proxy sample = plane();
    const auto chosen = where(sample, [](const auto& p) { return p[0] >= 10 && p[0] <= 20 && p[1] >= 30; });
    const auto found = region_of(sample, chosen, origin, std::nullopt, 1);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->region.kind(), Region::Kind::box);
    expect_exact(sample, chosen, found->region);
    const Box3d& box = found->region.bounds();
    EXPECT_NEAR(box.min[0], origin[0] + 9.5, 1e-6);
    EXPECT_NEAR(box.max[0], origin[0] + 20.5, 1e-6);
    EXPECT_NEAR(box.min[1], origin[1] + 29.5, 1e-6);
}

TEST(SampleRegion, IsTheRectangleThatWasDrawnInTheView)
{
    const Proxy sample = plane();
    const Matrix4d view = from_above();
    const double aspect = 4.0 / 3;
    const auto on_screen = [&](const std::array<float, 3>& p, std::size_t r) {
        return view[r] * p[0] + view[4 + r] * p[1] + view[8 + r] * p[2] + view[12 + r];
    };
    const auto chosen = where(sample, [&](const auto& p) {
        const double x = on_screen(p, 0) / on_screen(p, 3), y = on_screen(p, 1) / on_screen(p, 3);
        return std::fabs(x) < 0.2 && std::fabs(y - 0.1) < 0.15;
    });
    ASSERT_GT(chosen.size(), 500u);
    const auto found = region_of(sample, chosen, origin, view, aspect);
    ASSERT_TRUE(found);
    EXPECT_NE(found->words.find("rectangle"), std::string::npos);
    expect_exact(sample, chosen, found->region);
    EXPECT_FALSE(region_of(sample, chosen, origin, std::nullopt, 1)) << "no box along the axes is this rectangle";
}

TEST(SampleRegion, IsAPolygonWhereARectangleIsTooLarge)
{
    const Proxy sample = plane();
    const auto chosen = where(sample, [](const auto& p) { return std::hypot(p[0] - 50, p[1] - 40) < 12.3; });
    const auto found = region_of(sample, chosen, origin, from_above(), 1);
    ASSERT_TRUE(found);
    EXPECT_NE(found->words.find("polygon"), std::string::npos);
    expect_exact(sample, chosen, found->region);
}

TEST(SampleRegion, IsNoneForScatteredVertices)
{
    const Proxy sample = plane();
    const auto chosen = where(sample, [](const auto& p) { return int(p[0] + p[1]) % 2 == 0; });
    EXPECT_FALSE(region_of(sample, chosen, origin, from_above(), 1));
    EXPECT_FALSE(region_of(sample, {}, origin, from_above(), 1));
}

TEST(SampleRegion, GrowsByTheRoundingOfFloatsWhereTheSampleIsAllOfTheCloud)
{
    Proxy sample = plane();
    sample.spacing = 0;
    sample.is_whole = true;
    const auto chosen = where(sample, [](const auto& p) { return p[0] <= 20; });
    const auto found = region_of(sample, chosen, origin, std::nullopt, 1);
    ASSERT_TRUE(found);
    EXPECT_GT(found->region.bounds().max[0], origin[0] + 20);
    EXPECT_LT(found->region.bounds().max[0], origin[0] + 20.001);
}

}  // namespace
}  // namespace pcm::host
