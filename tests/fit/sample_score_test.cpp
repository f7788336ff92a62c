// Scores of samples against a plain sum over all points.
#include "pcm/fit/sample_score.h"

#include "pcm/fit/models/shape_models.h"
#include "tests/support.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace pcm;

constexpr double threshold = 0.03;

// Points about a sphere, with noise and outliers; some have normals of length 0.
struct Scene {
    Scene(std::size_t count, double noise, double outliers, bool normals) : sphere{ShapeKind::sphere, {}, {}, 0.5, 0}
    {
        std::mt19937_64 random(count);
        std::normal_distribution<double> normal;
        std::uniform_real_distribution<double> unit(-1, 1);
        std::vector<Vec3d> places, directions;
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3d away = normalised(Vec3d{normal(random), normal(random), normal(random)});
            const bool on = (unit(random) + 1) / 2 >= outliers;
            places.push_back(on ? (0.5 + noise * normal(random)) * away
                                : Vec3d{unit(random), unit(random), unit(random)});
            const Vec3d tilt{normal(random), normal(random), normal(random)};
            directions.push_back(i % 50 == 7 ? Vec3d{} : normalised(away + 0.5 * tilt));
            points.x.push_back(places.back()[0]);
            points.y.push_back(places.back()[1]);
            points.z.push_back(places.back()[2]);
            points.index.push_back(static_cast<std::uint32_t>(count - 1 - i));
        }
        std::reverse(places.begin(), places.end());
        std::reverse(directions.begin(), directions.end());
        for (std::size_t i = 0; i < count; ++i) normals ? given.add(places[i], directions[i]) : given.add(places[i]);
        points.given = &given;
    }

    // Infinite where the normal does not fit and the distance does.
    std::vector<double> distances(double least_cosine) const
    {
        std::vector<double> found;
        for (std::size_t i = 0; i < points.size(); ++i) {
            double distance = distance_to(sphere, points.at(i));
            if (points.has_normals() && least_cosine > 0 && distance <= threshold) {
                const Vec3d n = points.normal(i);
                if (length(n) > 0 && std::fabs(dot(n, normal_at(sphere, points.at(i)))) < least_cosine)
                    distance = std::numeric_limits<double>::infinity();
            }
            found.push_back(distance);
        }
        return found;
    }

    Shape sphere;
    WorkingPoints points;
    FitPoints given;
};

SampleScore::Value worst()
{
    SampleScore::Value value;
    value.score = value.of_first = std::numeric_limits<double>::infinity();
    return value;
}

TEST(SampleScores, OfCountsAndSquaresAreTheSumsOverAllPoints)
{
    for (const std::size_t count : {1u, 5u, 511u, 512u, 513u, 2048u, 8192u, 8193u, 20000u})
        for (const double least_cosine : {-1.0, 0.0, 0.9}) {
            const Scene scene(count, 0.02, 0.3, true);
            const std::vector<double> distances = scene.distances(least_cosine);
            double beyond = 0, squares = 0, of_first = 0;
            std::size_t inliers = 0;
            for (std::size_t i = 0; i < count; ++i) {
                const double d = distances[i] / threshold;
                inliers += d <= 1;
                beyond += !(d <= 1);
                squares += d <= 1 ? d * d : 1;
                if (i == 2047 && count > 8192) of_first = squares;
            }
            for (const SampleScoring scoring : {SampleScoring::count, SampleScoring::squares}) {
                SCOPED_TRACE(std::to_string(count) + " points, cosine " + std::to_string(least_cosine));
                SampleScore score(scene.points, sphere_model(), scoring, threshold, least_cosine);
                const SampleScore::Value value = score.of(scene.sphere, worst());
                EXPECT_EQ(value.inliers, inliers);
                EXPECT_NEAR(value.score, scoring == SampleScoring::count ? beyond : squares, 1e-9 * double(count));
                if (scoring == SampleScoring::squares) EXPECT_NEAR(value.of_first, of_first, 1e-9 * double(count));
                // As good as the best is not better; worse than that is given up.
                SampleScore::Value best = value;
                EXPECT_GE(score.of(scene.sphere, best).score, best.score);
                best.score = std::nextafter(value.score, std::numeric_limits<double>::infinity());
                EXPECT_EQ(score.of(scene.sphere, best).score, value.score);
                EXPECT_EQ(score.of(scene.sphere, best).inliers, inliers);
            }
        }
}

// The first 2048 of 20,000 points decide where they fail by more than two roots of their number.
TEST(SampleScores, AreGivenUpWhereTheFirstPointsFailByMoreThanChance)
{
    const Scene scene(20000, 0.02, 0.3, false);
    for (const SampleScoring scoring : {SampleScoring::count, SampleScoring::squares}) {
        SampleScore score(scene.points, sphere_model(), scoring, threshold, 0.9);
        const SampleScore::Value value = score.of(scene.sphere, worst());
        const double chance = 2 * std::sqrt(2048.0);
        SampleScore::Value best = worst();
        best.of_first = value.of_first - chance + 0.5;
        EXPECT_EQ(score.of(scene.sphere, best).score, value.score) << "as chance explains";
        best.of_first = value.of_first - chance - 0.5;
        EXPECT_EQ(score.of(scene.sphere, best).score, std::numeric_limits<double>::infinity());
    }
    const Scene few(8192, 0.02, 0.3, false);
    SampleScore score(few.points, sphere_model(), SampleScoring::count, threshold, -1);
    SampleScore::Value best = worst();
    best.of_first = 0;
    EXPECT_LT(score.of(few.sphere, best).score, 8192) << "of fewer all are looked at";
}

// The share of inliers by expectation maximisation that is repeated until it stands, without bins.
TEST(SampleScores, OfLikelihoodAreThoseOfTheMixture)
{
    for (const double outliers : {0.1, 0.5, 0.9})
        for (const std::size_t count : {600u, 4000u}) {
            const Scene scene(count, threshold / 3, outliers, true);
            for (const double least_cosine : {-1.0, 0.7}) {
                SampleScore score(scene.points, sphere_model(), SampleScoring::likelihood, threshold, least_cosine);
                const std::vector<double> distances = scene.distances(least_cosine);
                const double deviation = threshold / 3, density = 1 / (std::sqrt(2 * pi) * deviation);
                const auto gaussian = [&](double d) { return density * std::exp(-d * d / deviation / deviation / 2); };
                double share = 0.5;
                for (int round = 0; round < 500; ++round) {
                    double expected = 0;
                    for (const double d : distances)
                        expected += share * gaussian(d) / (share * gaussian(d) + (1 - share) * 0.5);
                    share = expected / double(count);
                }
                double expected = 0;
                std::size_t inliers = 0;
                for (const double d : distances) {
                    expected -= std::log(share * gaussian(d) + (1 - share) * 0.5);
                    inliers += d <= threshold;
                }
                const SampleScore::Value value = score.of(scene.sphere, worst());
                EXPECT_EQ(value.inliers, inliers);
                EXPECT_NEAR(value.score, expected, 0.002 * double(count));
                // A shape next to the points is less likely, and so is one of another size.
                for (Shape other : {scene.sphere, scene.sphere}) {
                    other.point[0] += 0.02;
                    EXPECT_GT(score.of(other, worst()).score, value.score);
                    other = scene.sphere;
                    other.radius += 0.02;
                    EXPECT_GT(score.of(other, worst()).score, value.score);
                }
            }
        }
}

TEST(SampleScores, NearPointsAreThoseWithinSoManyThresholds)
{
    const Scene scene(3000, 0.02, 0.3, true);
    for (const double least_cosine : {-1.0, 0.9}) {
        SampleScore score(scene.points, sphere_model(), SampleScoring::count, threshold, least_cosine);
        for (const double thresholds : {0.5, 1.0, 3.0}) {
            std::size_t roughly = 0;
            for (std::size_t i = 0; i < scene.points.size(); ++i) {
                const double distance = distance_to(scene.sphere, scene.points.at(i));
                const Vec3d n = scene.points.normal(i);
                const bool turned = least_cosine > 0 && length(n) > 0 &&
                                    std::fabs(dot(n, normal_at(scene.sphere, scene.points.at(i)))) < least_cosine;
                const bool near = distance <= thresholds * threshold;
                roughly += i < 512 && near;
                ASSERT_EQ(score.is_near(scene.sphere, i, thresholds), near && !turned);
                if (thresholds == 1) ASSERT_EQ(score.is_near(scene.sphere, i), near && !turned);
            }
            EXPECT_EQ(score.roughly_near(scene.sphere, thresholds), roughly);
        }
    }
}

}  // namespace
