// ErrorAgreement against the sums that its header states.
#include "pcm/place/error_agreement.h"

#include "tests/support.h"

#include <cmath>
#include <map>
#include <random>
#include <tuple>
#include <vector>

namespace {

using namespace pcm;

TEST(ErrorAgreement, IsTheRootOfWhatCubesHaveTogetherToWhatPointsHaveAlone)
{
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> unit(0, 10);
    std::normal_distribution<double> normal;
    const Vec3d corner{100, -50, 7};
    for (const double common : {0.0, 0.1, 1.0, 5.0}) {
        ErrorAgreement whole(corner, 2), first(corner, 2), second(corner, 2), without(corner, 0);
        std::map<std::tuple<int, int, int>, std::vector<double>> cubes;
        for (int i = 0; i < 4000; ++i) {
            const Vec3d p{unit(random), unit(random), unit(random)};
            const std::tuple<int, int, int> cube{int(p[0] / 2), int(p[1] / 2), int(p[2] / 2)};
            std::mt19937_64 of_cube(
                static_cast<unsigned>(std::get<0>(cube) + 10 * std::get<1>(cube) + 100 * std::get<2>(cube)));
            const double distance = normal(random) + common * (of_cube() % 2 ? 1 : -1);
            cubes[cube].push_back(distance);
            whole.add(corner + p, distance);
            (i < 1500 ? first : second).add(corner + p, distance);
            without.add(corner + p, distance);
        }
        double together = 0, alone = 0, fourth = 0;
        for (const auto& [cube, distances] : cubes) {
            double sum = 0, squares = 0;
            for (const double d : distances) sum += d, squares += d * d;
            together += sum * sum;
            alone += squares;
            fourth += squares * squares;
        }
        const double ratio = together / alone;
        const double expected = ratio > 1 + 3 * std::sqrt(2 * fourth) / alone ? std::sqrt(ratio) : 1;
        EXPECT_NEAR(whole.factor(), expected, 1e-9 * expected);
        if (common == 0) EXPECT_EQ(expected, 1);
        if (common >= 1) EXPECT_GT(expected, 3);
        first.add(second);
        EXPECT_NEAR(first.factor(), whole.factor(), 1e-9 * expected);
        EXPECT_EQ(without.factor(), 1);
    }
    EXPECT_EQ(ErrorAgreement(corner, 2).factor(), 1) << "without points";
    ErrorAgreement exact(corner, 2);
    exact.add(corner, 0);
    EXPECT_EQ(exact.factor(), 1);
    ShapeErrors errors{};
    errors.position = 1;
    errors.angle = 2;
    errors.radius = 3;
    errors.second = 4;
    enlarge(errors, 1.5);
    EXPECT_EQ(errors.position, 1.5);
    EXPECT_EQ(errors.angle, 3);
    EXPECT_EQ(errors.radius, 4.5);
    EXPECT_EQ(errors.second, 6);
}

}  // namespace
