// Pairs of parts next to the limits of joints, and bends that random pipes seldom have.
#include "pcm/piping/pipe_run.h"
#include "pcm/piping/tuning.h"
#include "tests/piping/random_pipes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace pcm {
namespace {

Primitive shaped(const char* shape, double from, double to, const Vec3d& zero = {})
{
    Primitive part;
    part.name = shape;
    part.fit.verdict = FitVerdict::good;
    part.fit.shape = parse_shape(shape);
    part.bounds.zero = zero;
    (zero == Vec3d{} ? part.bounds.from : part.bounds.begin) = from;
    (zero == Vec3d{} ? part.bounds.to : part.bounds.end) = to;
    return part;
}

// A pair is one pipe just within a limit and two just beyond it. Their radius is 1.
TEST(PipeLimits, EachLimitDecides)
{
    const JointTuning& joints = piping_tuning().joints;
    const CornerTuning& corners = piping_tuning().corners;
    const Primitive first = shaped("cylinder 0 0 0 1 0 0 1", 0, 20);
    const auto along = [&](double gap, double size) { return shaped("cylinder 20 0 0 1 0 0 1", gap, gap + size); };
    // A pipe upwards whose axis meets that of the first one `from_first` behind its end, from `begin` on.
    const auto upwards = [&](double from_first, double begin) {
        Primitive part = shaped("cylinder 20 0 0 0 0 1 1", begin, 20);
        part.fit.shape.point[0] += from_first;
        return part;
    };
    // A quarter turn upwards that begins `gap` behind the first one's end, and shows its arc from `open` on.
    const auto elbow = [&](double gap, double open, double bend) {
        Primitive part = shaped("torus 20 0 0 0 -1 0 5 1", open, pi / 2, {0, 0, -1});
        part.fit.shape.point = part.fit.shape.point + Vec3d{gap, 0, bend};
        part.fit.shape.radius = bend;
        return part;
    };
    struct Limit {
        const char* name;
        double value;
        std::function<Primitive(double)> other;
    };
    const Limit limits[] = {
        {"gap", joints.max_gap, [&](double v) { return along(v, 20); }},
        {"overlap", joints.max_overlap, [&](double v) { return along(-v, 20); }},
        {"overlap of a short pipe", 1, [&](double v) { return along(-v, 2); }},
        {"gap before an elbow", joints.max_gap, [&](double v) { return elbow(v, 0, 5); }},
        {"pipe that reaches into an elbow", 2 * std::sqrt(12.0), [&](double v) { return elbow(-v, 0, 12); }},
        {"elbow that reaches along a pipe", 2 / std::sqrt(12.0), [&](double v) { return elbow(0, -v, 12); }},
        {"open arc", joints.max_open_arc, [&](double v) { return elbow(0, v, 5); }},
        {"open arc of a wide bend", joints.max_gap / 30, [&](double v) { return elbow(0, v, 30); }},
        {"ends of different distance", corners.max_difference, [&](double v) { return upwards(2, 2 + v); }},
        {"gap before a corner", joints.max_gap, [&](double v) { return upwards(v, v); }},
    };
    for (const Limit& limit : limits) {
        EXPECT_EQ(pipe_runs({first, limit.other(0.98 * limit.value)}).size(), 1u) << limit.name;
        EXPECT_EQ(pipe_runs({first, limit.other(1.02 * limit.value)}).size(), 0u) << limit.name;
    }
    EXPECT_EQ(pipe_runs({first, upwards(1.02 * corners.min_bend, 1.02 * corners.min_bend)}).size(), 1u);
    EXPECT_EQ(pipe_runs({first, upwards(0.98 * corners.min_bend, 0.98 * corners.min_bend)}).size(), 0u);
}

TEST(PipeLimits, ArcsOfOneCircleContinueEachOther)
{
    const Primitive one = shaped("torus 0 0 0 0 0 1 5 1", 0, 1.4, {1, 0, 0});
    const Primitive next = shaped("torus 0 0 0 0 0 -1 5 1", 2 * pi - 2.5, 2 * pi - 1.6, {1, 0, 0});
    const std::vector<Primitive> list{one, next};
    const std::vector<PipeRun> runs = pipe_runs(list);
    ASSERT_EQ(runs.size(), 1u);
    EXPECT_NEAR(runs[0].length(), 5 * 2.5, 0.05);
    // Side by side they do not.
    Primitive beside = one;
    beside.fit.shape.point[2] = 2.2;
    EXPECT_TRUE(pipe_runs({one, beside}).empty());
}

// Two elbows have a curve in common as far as a pipe and the narrower one do.
TEST(PipeLimits, ElbowsOfDifferentBendsReachIntoEachOther)
{
    const Primitive narrow = shaped("torus 0 0 5 0 -1 0 5 1", -0.8, pi / 2, {0, 0, -1});
    const auto wide = [](double into) { return shaped("torus 25 0 5 0 1 0 20 1", -into / 20, pi / 2, {-1, 0, 0}); };
    const double limit = 2 * std::sqrt(5.0);
    for (const double share : {0.5, 0.98}) EXPECT_EQ(pipe_runs({narrow, wide(share * limit)}).size(), 1u) << share;
    EXPECT_EQ(pipe_runs({wide(0.98 * limit), narrow}).size(), 1u);
    EXPECT_TRUE(pipe_runs({narrow, wide(1.02 * limit)}).empty());
    EXPECT_TRUE(pipe_runs({wide(1.02 * limit), narrow}).empty());
}

TEST(PipeLimits, ATurnOfMoreThanHalfACircle)
{
    pipes::Random random(2);
    pipes::PipeLayer pipe(random, {}, {0, 0, 0}, {1, 0, 0}, 0.1);
    pipe.straight(1);
    pipe.elbow({0, 0, 1}, 1, 220 * degree);
    pipe.straight(1);
    const std::vector<PipeRun> runs = pipe_runs(pipe.parts());
    ASSERT_EQ(runs.size(), 1u);
    ASSERT_EQ(runs[0].bends(), 1u);
    EXPECT_NEAR(runs[0].line[1].angle, 220 * degree, 1e-9);
    EXPECT_NEAR(runs[0].line[1].length(), 220 * degree, 1e-9);
}

}  // namespace
}  // namespace pcm
