// Offsets of frames that are averaged.
#include "pcm/view/pixel_offset.h"

#include "pcm/cloud/vector.h"
#include "tests/view/random_views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

using namespace pcm;

// Each cell of 2^-a by 2^-b has one of the first 2^(a + b) offsets.
TEST(PixelOffset, IsEvenInEveryShapeOfCells)
{
    for (unsigned a = 0; a <= 5; ++a)
        for (unsigned b = 0; b <= 5; ++b) {
            std::set<std::array<int, 2>> cells;
            for (std::uint32_t i = 0; i < 1u << (a + b); ++i) {
                const auto sample = even_sample(i);
                for (const double v : sample) EXPECT_TRUE(v >= -0.5 && v < 0.5) << v;
                cells.insert({static_cast<int>(std::floor((sample[0] + 0.5) * (1 << a))),
                              static_cast<int>(std::floor((sample[1] + 0.5) * (1 << b)))});
            }
            EXPECT_EQ(cells.size(), std::size_t(1) << (a + b)) << a << " " << b;
        }
}

TEST(PixelOffset, TheFirstIsNoneAndTheMeanIsNearlyNone)
{
    for (const std::uint32_t frames : {8u, 16u, 64u}) {
        EXPECT_EQ(pixel_offset(0, frames), (std::array<double, 2>{0, 0}));
        std::array<double, 2> sum{};
        for (std::uint32_t i = 0; i < frames; ++i)
            for (std::size_t k = 0; k < 2; ++k) sum[k] += pixel_offset(i, frames)[k];
        // All but the first are in the middles of even cells, and there is none on the other side of the first.
        for (const double v : sum) EXPECT_LT(std::fabs(v) / frames, 0.7 / frames / frames) << frames;
    }
}

// Weights fall linearly from the pixel's centre to the reach: the share of offsets within a distance, and their
// variance, are a tent's, and x and y are independent.
TEST(PixelOffset, IsDistributedAsATent)
{
    constexpr std::uint32_t frames = 4096;
    std::array<double, 2> squares{};
    double product = 0;
    std::size_t within_half[2] = {0, 0};
    for (std::uint32_t i = 0; i < frames; ++i) {
        const auto offset = pixel_offset(i, frames);
        product += offset[0] * offset[1];
        for (std::size_t k = 0; k < 2; ++k) {
            EXPECT_LT(std::fabs(offset[k]), filter_reach);
            squares[k] += offset[k] * offset[k];
            within_half[k] += std::fabs(offset[k]) <= filter_reach / 2;
        }
    }
    for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_NEAR(squares[k] / frames, filter_reach * filter_reach / 6, 1e-3);
        EXPECT_NEAR(static_cast<double>(within_half[k]) / frames, 0.75, 1e-3);
    }
    EXPECT_NEAR(product / frames, 0, 1e-3);
}

// Worked out by hand: the second dimension's first eight of Sobol's sequence are 0, 1/2, 3/4, 1/4, 5/8, 1/8, 3/8, 7/8.
TEST(PixelOffset, IsTheKnownSequence)
{
    const double x[] = {0, -0.5, 0.25, -0.25, 0.125, -0.375, 0.375, -0.125};
    const double y[] = {0, -0.5, -0.25, 0.25, -0.375, 0.125, 0.375, -0.125};
    for (std::uint32_t i = 0; i < 8; ++i) EXPECT_EQ(even_sample(i), (std::array<double, 2>{x[i], y[i]})) << i;
}

// Every point moves by the offset and keeps its depth, in random views of either projection, off-axis ones too.
TEST(PixelOffset, MovesThePictureByPixels)
{
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    const Vec3d eye{500000, 4800000, 120}, origin{500100, 4800000, 0};
    std::size_t seen = 0;
    for (std::uint32_t i = 0; i < 500; ++i) {
        // A whole pixel along one axis too.
        const std::array<double, 2> offset = i % 40 == 39
                                                 ? std::array<double, 2>{double(i % 80 == 39), double(i % 80 != 39)}
                                                 : pixel_offset(1 + i % 40, 41);
        const Camera view = test::random_view(random, eye, origin, 200);
        const Camera moved = shifted(view, offset);
        EXPECT_EQ(moved.modelview, view.modelview);
        EXPECT_EQ(shifted(view, {0, 0}).projection, view.projection);
        for (int k = 0; k < 40; ++k) {
            const Vec3d point = eye + 200 * Vec3d{unit(random), unit(random), unit(random)};
            const auto before = test::clip(view, point), after = test::clip(moved, point);
            EXPECT_EQ(after[2], before[2]);
            EXPECT_EQ(after[3], before[3]);
            if (!test::is_visible(before)) continue;
            ++seen;
            EXPECT_NEAR((after[0] - before[0]) / before[3] * view.width / 2, offset[0], 1e-6);
            EXPECT_NEAR((after[1] - before[1]) / before[3] * view.height / 2, offset[1], 1e-6);
        }
    }
    EXPECT_GT(seen, 500u);
}
