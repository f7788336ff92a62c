// Lengths of runs and their standard deviations, on pipes whose parts have points of each other as detected ones do.
#include "pcm/piping/pipe_run.h"
#include "pcm/piping/run_errors.h"
#include "tests/piping/random_pipes.h"

#include <gtest/gtest.h>

namespace pcm {
namespace {

using pipes::Noise;
using pipes::PipeLayer;
using pipes::Random;
using pipes::uniform;

// With this number of points a free end is exact: the errors are those of axes and bends.
constexpr std::uint64_t countless = std::uint64_t(1) << 62;

Noise fitted_noise()
{
    Noise noise = pipes::usual_noise();
    noise.angle = 0.002;
    noise.open = 0;
    return noise;
}

// Moves the end of a cylinder that is nearer to `place` outwards.
void lengthen(Primitive& pipe, const Vec3d& place, double by)
{
    const Shape& shape = pipe.fit.shape;
    const double at = dot(place - shape.point, shape.axis);
    if (std::fabs(at - pipe.bounds.from) < std::fabs(at - pipe.bounds.to))
        pipe.bounds.from -= by;
    else
        pipe.bounds.to += by;
}

// Two straight pipes and a bend, of which each has points of the others: pipes up to `pipe_reach` radii, elbows up to
// `elbow_reach`, where that is less than half of what they are reached from.
struct Bent {
    std::vector<Primitive> parts;
    double length = 0;

    Bent(Random& random, const Noise& noise, const Vec3d& place, double radius, double bend, double turn,
         bool has_elbow, double pipe_reach, double elbow_reach)
    {
        PipeLayer pipe(random, noise, place, pipes::unit_vector(random), radius);
        pipe.straight(12 * radius);
        const Vec3d begin = pipe.place();
        pipe.elbow(pipe.any_axis(), bend, turn, has_elbow);
        const Vec3d end = pipe.place();
        pipe.straight(15 * radius);
        parts = pipe.parts();
        length = pipe.length();
        for (Primitive& part : parts) part.points = countless;
        const double most = 0.4 * bend * turn;
        lengthen(parts.front(), begin, std::min(pipe_reach * radius, most));
        lengthen(parts.back(), end, std::min(pipe_reach * radius, most));
        if (!has_elbow) return;
        const double more = std::min(elbow_reach * radius, most) / bend;
        ShapeBounds& arc = parts[1].bounds;
        if (arc.end - arc.begin + 2 * more >= 2 * pi) return;
        arc.begin -= more;
        arc.end += more;
        if (arc.begin < 0) {
            arc.begin += 2 * pi;
            arc.end += 2 * pi;
        }
    }
};

struct Shares {
    std::size_t runs = 0, within_two = 0;
    double squares = 0;
    void add(double error_share)
    {
        ++runs;
        within_two += std::fabs(error_share) <= 2;
        squares += error_share * error_share;
    }
    double within() const { return static_cast<double>(within_two) / static_cast<double>(runs); }
    double spread() const { return std::sqrt(squares / static_cast<double>(runs)); }
};

constexpr double radii[] = {0.02, 0.11, 0.3};
constexpr double bends[] = {2, 3, 5};  // radii
constexpr double turns[] = {5, 20, 45, 90, 135, 180};

// Errors of 200 runs of each size: a length that is off by more than two standard deviations is one in twenty at most,
// and its standard deviations are not several times too large.
TEST(RunLength, ElbowsHoldTheLengthWhateverPipesAndElbowsHaveOfEachOther)
{
    Random random(5);
    for (const Vec3d& origin : {Vec3d{0, 0, 0}, Vec3d{431200, 5412300, 120}, Vec3d{-1e6, 1e6, 0}})
        for (const double turn : turns) {
            Shares shares;
            std::size_t missing = 0;
            for (const double radius : radii)
                for (const double bend : bends)
                    for (int round = 0; round < 60; ++round) {
                        const Bent bent(random, fitted_noise(), origin, radius, bend * radius, turn * degree, true,
                                        uniform(random, 0, 1.8), uniform(random, 0, 2.7));
                        const std::vector<PipeRun> runs = pipe_runs(bent.parts);
                        if (runs.size() != 1 || runs[0].parts.size() != 3) {
                            ++missing;
                            continue;
                        }
                        ASSERT_GT(runs[0].length_error, 0);
                        shares.add((runs[0].length() - bent.length) / runs[0].length_error);
                    }
            EXPECT_LE(missing, 540 / 100) << turn;
            EXPECT_GE(shares.within(), 0.95) << turn << " degrees: " << shares.spread();
            EXPECT_GE(shares.spread(), 0.15) << turn;
            RecordProperty("spread_" + std::to_string(int(turn)), std::to_string(shares.spread()));
        }
}

TEST(RunLength, ExactPartsHaveAnExactLength)
{
    Random random(6);
    Noise exact;
    exact.open = 0;
    for (const double turn : turns)
        for (const double radius : radii) {
            const Bent bent(random, exact, {-1e6, 1e6, 0}, radius, 3 * radius, turn * degree, true, 1.5, 1.5);
            const std::vector<PipeRun> runs = pipe_runs(bent.parts);
            ASSERT_EQ(runs.size(), 1u) << turn;
            ASSERT_EQ(runs[0].parts.size(), 3u) << turn;
            EXPECT_NEAR(runs[0].length(), bent.length, 1e-8) << turn;
            EXPECT_EQ(runs[0].length_error, 0) << "errors of the parts are not known";
        }
}

// Without an elbow the length is too long by what the pipes have of the bend, which its standard deviation holds.
TEST(RunLength, AssumedBendsSayHowFarTheyMayBeOff)
{
    Random random(7);
    for (const double turn : {30.0, 60.0, 90.0, 120.0}) {
        Shares shares;
        for (const double radius : radii)
            for (int round = 0; round < 100; ++round) {
                const double reach = uniform(random, 0, 1.7);
                const Bent bent(random, fitted_noise(), {1000, 2000, 30}, radius, 4 * radius, turn * degree, false,
                                reach, 0);
                const std::vector<PipeRun> runs = pipe_runs(bent.parts);
                if (runs.size() != 1) continue;
                EXPECT_FALSE(runs[0].line[1].is_measured);
                shares.add((runs[0].length() - bent.length) / runs[0].length_error);
            }
        EXPECT_GE(shares.runs, 100u) << turn;
        EXPECT_GE(shares.within(), 0.95) << turn;
    }
}

TEST(RunLength, FreeEndsAreAsUncertainAsPointsAreApart)
{
    Random random(8);
    PipeLayer pipe(random, fitted_noise(), {1, 2, 3}, {1, 0, 0}, 0.1);
    pipe.straight(2);
    pipe.straight(3);
    std::vector<Primitive> parts = pipe.parts();
    parts[0].points = 1000;
    parts[1].points = 3000;
    parts[0].fit.noise = parts[1].fit.noise = 0.002;
    // The fitted radii differ from 0.1 a little. One end of each is free: 2 pi 0.1 2 / 1000 and 2 pi 0.1 3 / 3000 are
    // the areas of their points.
    const double areas = 2 * pi * 0.1 * (2.0 / 1000 + 3.0 / 3000);
    EXPECT_NEAR(pipe_runs(parts)[0].length_error, std::sqrt(areas + 2 * 0.002 * 0.002), 2e-4);
    parts[1].fit.errors.radius = 0;
    EXPECT_EQ(pipe_runs(parts)[0].length_error, 0);
}

// By how much a length changes with the numbers of the bend that it is stated for.
TEST(RunLength, ErrorsOfBendsAreTheirDerivatives)
{
    using piping::length_error;
    using piping::RunBend;
    EXPECT_EQ(length_error({}, {3, 4}), 5);
    for (const double turn : {5 * degree, 45 * degree, 90 * degree, 135 * degree}) {
        RunBend bend;
        bend.turn = turn;
        bend.tangent_error = 0.001;
        // Tangents u and arc u turn / tan(turn / 2).
        const auto length_of = [&](double u) { return 10 - 2 * u + u * turn / std::tan(turn / 2); };
        EXPECT_NEAR(length_error({bend}, {0, 0}), std::fabs(length_of(0.301) - length_of(0.3)), 1e-12);
        RunBend other;
        other.turn = turn;
        other.place_error = 0.001;
        EXPECT_NEAR(length_error({other}, {0, 0}), 0.001 * std::min(std::tan(turn / 2), 2.0), 1e-15);
        EXPECT_NEAR(length_error({bend, other}, {0, 0}),
                    std::hypot(length_error({bend}, {0, 0}), length_error({other}, {0, 0})), 1e-15);
    }
    RunBend slight;
    slight.arc = 0.01;
    slight.place_error = 0.001;
    EXPECT_NEAR(length_error({slight}, {0, 0}), 2 * (std::hypot(0.01, 0.001) - 0.01), 1e-6);
    RunBend back;
    back.turn = pi;
    back.tangent_error = back.place_error = 1;
    EXPECT_NEAR(length_error({back}, {0, 0}), std::sqrt(8), 1e-12);
}

}  // namespace
}  // namespace pcm
