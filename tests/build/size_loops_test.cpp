// The loops that find sizes: each level of vector instructions against plain ones, to the last bit.

#include "pcm/build/nodes/size_loops.h"

#include "pcm/build/nodes/size_codes.h"
#include "pcm/system/cpu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

namespace pcm {
namespace {

const SizeLoops& loops_of(SimdLevel level)
{
    if (level == SimdLevel::avx512) return avx512_size_loops();
    return level == SimdLevel::avx2 ? avx2_size_loops() : baseline_size_loops();
}

void run(const SizeLoops& loops, const std::vector<float>& groups, std::vector<float>& to)
{
    loops.distances(groups.data(), to.size() / size_group, to.data());
}
void run(const SizeLoops& loops, const std::vector<double>& groups, std::vector<float>& to)
{
    loops.distances_in_double(groups.data(), to.size() / size_group, to.data());
}

template <class Real>
float plain_distance(const std::vector<Real>& groups, std::size_t point)
{
    const auto at = [&](std::size_t i, std::size_t a) {
        return groups[i / size_group * 3 * size_group + a * size_group + i % size_group];
    };
    const std::size_t points = groups.size() / 3, group = point / size_group * size_group;
    std::vector<Real> squares;
    for (std::size_t i = group < size_group ? 0 : group - size_group; i < std::min(points, group + 2 * size_group);
         ++i) {
        const Real x = at(point, 0) - at(i, 0), y = at(point, 1) - at(i, 1), z = at(point, 2) - at(i, 2);
        const Real square = x * x + y * y + z * z;
        if (i != point && square < std::numeric_limits<Real>::infinity()) squares.push_back(square);
    }
    std::sort(squares.begin(), squares.end());
    return squares.empty() ? 0 : static_cast<float>(std::sqrt(squares[std::min<std::size_t>(4, squares.size()) - 1]));
}

template <class Real>
class SizeLoop : public testing::Test {
};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(SizeLoop, Reals);

TYPED_TEST(SizeLoop, DistancesAreThoseOfPlainLoops)
{
    using Real = TypeParam;
    std::mt19937_64 random(3);
    for (const std::size_t groups : {1u, 2u, 3u, 7u})
        for (const std::size_t absent : {0u, 1u, 27u, 30u, 31u}) {  // at the end of the last group
            std::vector<Real> values(groups * 3 * size_group);
            for (Real& v : values) v = static_cast<Real>(random() % 100000) * static_cast<Real>(0.37);
            for (std::size_t a = 0; a < 3; ++a)
                std::fill_n(values.end() - static_cast<std::ptrdiff_t>(a * size_group + absent), absent,
                            std::numeric_limits<Real>::infinity());
            for (const SimdLevel level : simd_levels()) {
                std::vector<float> distances(groups * size_group);
                run(loops_of(level), values, distances);
                for (std::size_t i = 0; i < groups * size_group - absent; ++i)
                    ASSERT_EQ(distances[i], plain_distance(values, i)) << name_of(level) << ' ' << groups << ' ' << i;
            }
        }
}

TEST(SizeLoops, MiddlesAreThoseOfSortedGroups)
{
    std::mt19937_64 random(4);
    for (const std::size_t groups : {0u, 1u, 3u, 4u, 5u, 8u, 15u, 16u, 17u, 40u})
        for (const std::uint64_t different : {2u, 9u, 1000000u}) {
            std::vector<float> distances(groups * size_group);
            for (float& d : distances) d = static_cast<float>(random() % different);
            for (const SimdLevel level : simd_levels()) {
                std::vector<float> middles(groups + 1, -1);
                loops_of(level).middles(distances.data(), groups, middles.data());
                for (std::size_t g = 0; g < groups; ++g) {
                    std::vector<float> group(distances.begin() + static_cast<std::ptrdiff_t>(g * size_group),
                                             distances.begin() + static_cast<std::ptrdiff_t>((g + 1) * size_group));
                    std::sort(group.begin(), group.end());
                    ASSERT_EQ(middles[g], group[size_group / 2]) << name_of(level) << ' ' << g << " of " << groups;
                }
                ASSERT_EQ(middles[groups], -1);  // nothing behind them
            }
        }
}

TEST(SizeCodes, AreThoseOfTheLogarithm)
{
    std::mt19937_64 random(5);
    for (const double least : {0.5, 0.8660254037844386, 1.0, 3e-7}) {
        std::vector<float> distances{0, 0.25f, 0.5f, 1, 2, 1e6f, 1e12f};
        for (int code = 0; code < 200; ++code) {  // on both sides of where codes begin
            float at = static_cast<float>(least * std::exp2(code / 4.0));
            for (int n = 0; n < 8; ++n) at = std::nextafter(at, 0.0f);
            for (int n = 0; n < 16; ++n) distances.push_back(at = std::nextafter(at, 1e30f));
        }
        for (int n = 0; n < 10000; ++n)
            distances.push_back(std::exp2(static_cast<float>(random() % 1000000) / 1e6f * 30 - 3));
        const auto [nearest, farthest] = std::minmax_element(distances.begin(), distances.end());
        const SizeCodes code_of(*nearest, *farthest, least);
        for (const float d : distances)
            ASSERT_EQ(code_of(d), size_code(static_cast<double>(d), least)) << d << " of " << least;
    }
}

}  // namespace
}  // namespace pcm
