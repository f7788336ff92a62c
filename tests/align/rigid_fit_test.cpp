// Motions from pairs of points: against known motions, at all scales and map coordinates, and all that is refused.
#include "pcm/align/rigid_fit.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace pcm {
namespace {

struct Truth {
    Affine map;
    std::vector<PointPair> pairs;
};

// Pairs of points that a known motion maps without error, `extent` across, about `place`.
Truth truth(std::size_t count, double extent, const Vec3d& place, const Vec3d& axis, double radians, const Vec3d& shift,
            double scale = 1, unsigned seed = 1)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> within(-0.5, 0.5);
    Truth t;
    t.map = Affine::rotation(axis, radians, place, scale);
    t.map.target = t.map.target + shift;
    for (std::size_t i = 0; i < count; ++i) {
        Vec3d p;
        for (double& x : p) x = extent * within(random);
        p = p + place;
        t.pairs.push_back({p, t.map(p)});
    }
    return t;
}

// The largest distance between two maps at the corners of a cube about `place`.
double apart(const Affine& a, const Affine& b, const Vec3d& place, double extent)
{
    double largest = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        Vec3d p = place;
        for (std::size_t k = 0; k < 3; ++k) p[k] += (corner >> k & 1u ? 0.5 : -0.5) * extent;
        largest = std::max(largest, length(a(p) - b(p)));
    }
    return largest;
}

std::string refusal(const std::vector<PointPair>& pairs, const FitOptions& options = {})
{
    try {
        fit_motion(pairs, options);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        return error.what();
    }
    return "accepted";
}

#define EXPECT_REFUSED(pairs, text, ...)                                    \
    do {                                                                    \
        const std::string why = refusal(pairs, ##__VA_ARGS__);              \
        EXPECT_NE(why.find(text), std::string::npos) << "refusal: " << why; \
    } while (false)

TEST(RigidFit, FindsAKnownMotionAtAnySizeAndPlace)
{
    const Vec3d places[] = {{0, 0, 0}, {500000, 4800000, 120}, {-9.5e6, 9.9e6, -1e6}};
    for (const double extent : {1e-6, 1.0, 300.0, 1e9})
        for (const Vec3d& place : places)
            for (const double radians : {0.0, 1e-9, 0.3, pi / 2, 3.0, pi})
                for (const std::size_t count : {3u, 4u, 25u}) {
                    const Vec3d shift = extent * Vec3d{0.7, -2, 0.1};
                    const Truth t = truth(count, extent, place, {1, -2, 0.5}, radians, shift);
                    double magnitude = extent;
                    for (const PointPair& pair : t.pairs)
                        magnitude =
                            std::max({magnitude, largest_magnitude(pair.moving), largest_magnitude(pair.fixed)});
                    if (1e-16 * magnitude > 1e-6 * extent) continue;  // the coordinates have no digits for it
                    const RigidFit fit = fit_motion(t.pairs);
                    // The coordinates of the pairs are rounded by this much, and the fit may be no worse.
                    const double rounding = 20 * 2.3e-16 * magnitude;
                    const double allowed = std::max(1e-12 * extent, rounding);
                    EXPECT_LT(apart(fit.motion, t.map, place, extent), 20 * allowed)
                        << extent << " about " << place[0] << ", " << count << " pairs, " << radians;
                    EXPECT_LE(fit.rms, allowed);
                    EXPECT_NEAR(fit.radians, radians, 20 * allowed / extent);
                    EXPECT_NEAR(fit.motion.determinant(), 1, 1e-12);
                    EXPECT_EQ(fit.scale, 1);
                    const Affine again = Affine::rotation(fit.axis, fit.radians, fit.motion.pivot);
                    for (std::size_t r = 0; r < 3; ++r)
                        EXPECT_LT(length(again.linear[r] - fit.motion.linear[r]), 1e-13) << radians;
                }
}

TEST(RigidFit, NamesTheAxisAndTheAngle)
{
    const Truth t = truth(5, 100, {10, 20, 30}, {0, 0, -1}, 0.25, {1, 2, 3});
    const RigidFit fit = fit_motion(t.pairs);
    EXPECT_NEAR(fit.radians, 0.25, 1e-13);
    EXPECT_NEAR(fit.axis[2], -1, 1e-12);
    const Affine again = Affine::rotation(fit.axis, fit.radians, fit.motion.pivot);
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(again.linear[r][c], fit.motion.linear[r][c], 1e-14);
    EXPECT_EQ(fit.shift, fit.motion.target - fit.motion.pivot);
}

TEST(RigidFit, FitsAScaleOnlyWhenAsked)
{
    const Vec3d place{500000, 4800000, 120};
    const Truth t = truth(6, 80, place, {1, 1, 3}, 1.1, {-3, 8, 2}, 0.3048);
    FitOptions with_scale;
    with_scale.scale = true;
    const RigidFit scaled = fit_motion(t.pairs, with_scale);
    EXPECT_NEAR(scaled.scale, 0.3048, 1e-10);
    EXPECT_LT(apart(scaled.motion, t.map, place, 80), 1e-7);
    const RigidFit rigid = fit_motion(t.pairs);
    EXPECT_EQ(rigid.scale, 1);
    EXPECT_NEAR(rigid.pairs_scale, 0.3048, 1e-10);
    EXPECT_GT(rigid.rms, 1);
}

// Near a line the normal matrix has lost the digits that the residuals still have.
TEST(RigidFit, ThinSpreadsKeepTheirDigits)
{
    for (const double thickness : {1e-2, 1e-4, 2e-6}) {
        Truth t = truth(0, 1, {0, 0, 0}, {1, 2, 3}, 0.8, {5, 6, 7});
        for (const Vec3d& p : {Vec3d{0, 0, 0}, Vec3d{1, thickness, 0}, Vec3d{2, 0, thickness}, Vec3d{3, thickness, 0}})
            t.pairs.push_back({p, t.map(p)});
        const RigidFit fit = fit_motion(t.pairs);
        EXPECT_LT(fit.rms, 1e-14) << thickness;
        EXPECT_LT(apart(fit.motion, t.map, {0, 0, 0}, 1), 1e-14 / thickness) << thickness;
    }
}

// Among all motions near it, the fit has the least sum of squares; weights count.
TEST(RigidFit, NoMotionNearbyFitsBetter)
{
    Truth t = truth(7, 10, {1000, 2000, 50}, {0, 1, 1}, 0.5, {1, 1, 1}, 1.2);
    std::mt19937_64 random(3);
    std::normal_distribution<double> noise(0, 0.1);
    for (std::size_t i = 0; i < t.pairs.size(); ++i) {
        for (double& x : t.pairs[i].fixed) x += noise(random);
        t.pairs[i].weight = 0.25 + double(i);
    }
    for (const bool with_scale : {false, true}) {
        FitOptions options;
        options.scale = with_scale;
        const RigidFit fit = fit_motion(t.pairs, options);
        const auto squares = [&](const Affine& map) {
            double sum = 0, weights = 0;
            for (const PointPair& pair : t.pairs) {
                const Vec3d d = pair.fixed - map(pair.moving);
                sum += pair.weight * dot(d, d);
                weights += pair.weight;
            }
            return sum / weights;
        };
        const double least = squares(fit.motion);
        EXPECT_NEAR(std::sqrt(least), fit.rms, 1e-12);
        for (std::size_t a = 0; a < 3; ++a)
            for (const double step : {-1e-4, 1e-4}) {
                Affine moved = fit.motion;
                moved.target[a] += step;
                EXPECT_GT(squares(moved), least);
                Vec3d axis{};
                axis[a] = 1;
                const Affine turn = Affine::rotation(axis, step, fit.motion.target);
                Affine turned = fit.motion;
                for (std::size_t r = 0; r < 3; ++r)
                    for (std::size_t c = 0; c < 3; ++c) {
                        turned.linear[r][c] = 0;
                        for (std::size_t k = 0; k < 3; ++k)
                            turned.linear[r][c] += turn.linear[r][k] * fit.motion.linear[k][c];
                    }
                EXPECT_GT(squares(turned), least);
                if (!with_scale) continue;
                Affine stretched = fit.motion;
                for (Vec3d& row : stretched.linear) row = (1 + step) * row;
                EXPECT_GT(squares(stretched), least);
            }
    }
}

TEST(RigidFit, ResidualsAreThoseOfTheMotion)
{
    Truth t = truth(4, 20, {500000, 4800000, 100}, {0, 0, 1}, 0.2, {4, 5, 6});
    t.pairs[2].fixed = t.pairs[2].fixed + Vec3d{0.5, 0, 0};
    t.pairs.push_back({t.pairs[0].moving, t.pairs[0].fixed + Vec3d{0, 0, 9}, 0});
    const RigidFit fit = fit_motion(t.pairs);
    ASSERT_EQ(fit.residuals.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(length(t.pairs[i].fixed - fit.motion(t.pairs[i].moving)), fit.residuals[i], 1e-8);
        EXPECT_EQ(length(fit.offsets[i]), fit.residuals[i]);
    }
    EXPECT_GT(fit.residuals[4], 8.5);  // weight 0: reported, and of no effect
    EXPECT_LT(fit.rms, 0.5);
}

// The errors that it states are those of many fits of noisy pairs.
TEST(RigidFit, UncertaintyIsThatOfRepeatedPicks)
{
    for (const bool with_scale : {false, true}) {
        const Vec3d place{500000, 4800000, 100};
        const Truth t = truth(5, 50, place, {0.2, 0.1, 1}, 0.7, {4, 5, 6}, 1, 9);
        const double sigma = 0.02;
        const Vec3d far = place + Vec3d{200, -100, 30};
        std::mt19937_64 random(5);
        std::normal_distribution<double> noise(0, sigma);
        FitOptions options;
        options.scale = with_scale;
        double near_squares = 0, stated = 0, coordinate = 0;
        std::array<Vec3d, 3> far_covariance{};
        constexpr int fits = 4000;
        for (int i = 0; i < fits; ++i) {
            auto pairs = t.pairs;
            for (PointPair& pair : pairs)
                for (double& x : pair.fixed) x += noise(random);
            const RigidFit fit = fit_motion(pairs, options);
            const Vec3d d = fit.motion(far) - t.map(far);
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c) far_covariance[r][c] += d[r] * d[c] / fits;
            const Vec3d n = fit.motion(fit.motion.pivot) - t.map(fit.motion.pivot);
            near_squares += dot(n, n) / 3 / fits;
            stated += fit.error_at(far) / fits;
            coordinate += fit.coordinate_error * fit.coordinate_error / fits;
        }
        EXPECT_NEAR(std::sqrt(coordinate), sigma, 0.03 * sigma);
        EXPECT_NEAR(std::sqrt(near_squares), sigma / std::sqrt(5.0), 0.05 * sigma);
        // The largest standard deviation in any direction, by power iteration.
        Vec3d u{1, 1, 1};
        for (int i = 0; i < 200; ++i)
            u = normalised(Vec3d{dot(far_covariance[0], u), dot(far_covariance[1], u), dot(far_covariance[2], u)});
        const double observed =
            std::sqrt(dot(u, Vec3d{dot(far_covariance[0], u), dot(far_covariance[1], u), dot(far_covariance[2], u)}));
        EXPECT_NEAR(stated, observed, 0.06 * observed) << with_scale;
    }
}

TEST(RigidFit, UncertaintyDoesNotDependOnWhichAxisIsWhich)
{
    const Truth t = truth(6, 20, {0, 0, 0}, {0.3, 0.5, 1}, 0.4, {4, 5, 6});
    FitOptions options;
    options.pick_error = 0.01;
    const auto turned = [](const Vec3d& v, std::size_t by) {
        return Vec3d{v[by % 3], v[(by + 1) % 3], v[(by + 2) % 3]};
    };
    for (const Vec3d far : {Vec3d{200, 0, 0}, Vec3d{0, 200, 0}, Vec3d{0, 0, 200}, Vec3d{90, -80, 150}}) {
        const double expected = fit_motion(t.pairs, options).error_at(far);
        EXPECT_GT(expected, 2 * options.pick_error);
        for (const std::size_t by : {1u, 2u}) {
            std::vector<PointPair> pairs;
            for (const PointPair& pair : t.pairs) pairs.push_back({turned(pair.moving, by), turned(pair.fixed, by)});
            EXPECT_NEAR(fit_motion(pairs, options).error_at(turned(far, by)), expected, 1e-9 * expected) << by;
        }
    }
}

TEST(RigidFit, ThePickErrorIsAFloorAndTheBoxesCornerTheWorst)
{
    const Truth t = truth(4, 20, {0, 0, 0}, {0, 0, 1}, 0.2, {4, 5, 6});
    FitOptions options;
    options.pick_error = 0.01;
    const RigidFit fit = fit_motion(t.pairs, options);
    EXPECT_NEAR(fit.coordinate_error, std::sqrt(2.0) * 0.01, 1e-12);
    EXPECT_NEAR(fit.error_at(fit.motion.pivot), fit.coordinate_error / 2, 1e-12);
    const Box3d box{{-100, -50, -5}, {30, 60, 5}};
    const double largest = fit.largest_error(box);
    EXPECT_GT(largest, fit.error_at(fit.motion.pivot));
    std::mt19937_64 random(1);
    for (int i = 0; i < 2000; ++i) {
        Vec3d p;
        for (std::size_t a = 0; a < 3; ++a)
            p[a] = std::uniform_real_distribution<double>(box.min[a], box.max[a])(random);
        EXPECT_LE(fit.error_at(p), largest);
    }
    EXPECT_EQ(fit_motion(t.pairs).largest_error(Box3d{}), 0);
}

TEST(RigidFit, RefusesTooFewPairsAndBadNumbers)
{
    Truth t = truth(4, 20, {0, 0, 0}, {0, 0, 1}, 0.2, {4, 5, 6});
    EXPECT_REFUSED({}, "needs three pairs of points, and there are 0");
    EXPECT_REFUSED(std::vector<PointPair>(t.pairs.begin(), t.pairs.begin() + 2), "and there are 2");
    auto pairs = t.pairs;
    pairs[1].weight = pairs[2].weight = 0;
    EXPECT_REFUSED(pairs, "and there are 2");
    pairs[1].weight = -1;
    EXPECT_REFUSED(pairs, "pair 2 has a weight");
    pairs = t.pairs;
    pairs[2].fixed[1] = std::nan("");
    EXPECT_REFUSED(pairs, "pair 3: the place");
    pairs[2].fixed[1] = 0;
    pairs[0].moving[0] = INFINITY;
    EXPECT_REFUSED(pairs, "pair 1: the place");
    FitOptions options;
    options.pick_error = -1;
    EXPECT_REFUSED(t.pairs, "uncertainty of the picked points", options);
}

TEST(RigidFit, RefusesPointsThatCoincideOrLieOnALine)
{
    for (const Vec3d& place : {Vec3d{0, 0, 0}, Vec3d{500000, 4800000, 100}}) {
        Truth t = truth(4, 20, place, {0, 0, 1}, 0.2, {4, 5, 6});
        auto pairs = t.pairs;
        for (PointPair& pair : pairs) pair.moving = pairs[0].moving;
        EXPECT_REFUSED(pairs, "points of the moving cloud coincide");
        pairs = t.pairs;
        pairs[3].fixed = pairs[1].fixed;
        EXPECT_REFUSED(pairs, "points of the fixed cloud in pairs 2 and 4 coincide");
        pairs.clear();
        for (int i = 0; i < 5; ++i) {
            const Vec3d p = place + Vec3d{1.0 * i, 2.0 * i, 0.5 * i};
            pairs.push_back({p, t.map(p)});
        }
        EXPECT_REFUSED(pairs, "points of the moving cloud lie on one line");
        pairs[4].moving = pairs[4].moving + Vec3d{1, 0, 0};
        EXPECT_REFUSED(pairs, "points of the fixed cloud lie on one line");
        // Exact points of a spread that is lost in the rotation are a line too.
        auto thin = pairs;
        for (std::size_t i = 0; i < thin.size(); ++i) {
            const Vec3d p{1e-7 * double(i % 2), 10.0 * double(i), 0};
            thin[i] = {p, p, 1};
        }
        EXPECT_REFUSED(thin, "lie on one line");
        // A centimetre off the line is enough for exact points, and not for picks of 2 cm.
        pairs[4].moving = place + Vec3d{4, 8, 2.01};
        pairs[4].fixed = t.map(pairs[4].moving);
        EXPECT_EQ(refusal(pairs), "accepted");
        FitOptions options;
        options.pick_error = 0.02;
        EXPECT_REFUSED(pairs, "lie on one line", options);
        options.pick_error = 50;
        EXPECT_REFUSED(t.pairs, "not more than they can be picked to", options);
    }
}

TEST(RigidFit, RefusesMirrorImages)
{
    Truth t = truth(5, 20, {500000, 4800000, 100}, {0, 0, 1}, 0.2, {4, 5, 6});
    for (PointPair& pair : t.pairs) pair.moving[0] = 1e6 - pair.moving[0];
    EXPECT_REFUSED(t.pairs, "mirror image");
    // Points of one plane have no mirror image of their own: they are turned over.
    for (PointPair& pair : t.pairs) pair.moving[2] = 100;
    for (PointPair& pair : t.pairs) pair.fixed = t.map({1e6 - pair.moving[0], pair.moving[1], 100});
    const RigidFit fit = fit_motion(t.pairs);
    EXPECT_LT(fit.rms, 1e-8);
    EXPECT_NEAR(fit.motion.determinant(), 1, 1e-12);
}

TEST(RigidFit, RefusesPairsThatDetermineNoRotation)
{
    // Along y, the places of the one cloud have nothing to do with those of the other: any rotation about x is as good.
    std::vector<PointPair> pairs{
        {{5, 1, 0}, {5, 1, 0}}, {{5, -1, 0}, {5, -1, 0}}, {{-5, 1, 0}, {-5, -1, 0}}, {{-5, -1, 0}, {-5, 1, 0}}};
    EXPECT_REFUSED(pairs, "do not determine a rotation");
}

}  // namespace
}  // namespace pcm
