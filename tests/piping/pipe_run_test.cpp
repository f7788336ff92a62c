#include "pcm/piping/pipe_run.h"

#include "pcm/piping/tuned_values.h"
#include "pcm/piping/tuning.h"
#include "pcm/system/error.h"
#include "tests/piping/random_pipes.h"

#include <gtest/gtest.h>

#include <set>
#include <sstream>

namespace pcm {
namespace {

using pipes::Noise;
using pipes::PipeLayer;
using pipes::Random;
using pipes::uniform;
using pipes::usual_noise;

std::string names_of(const PipeRun& run)
{
    std::string names = parts_text(run);
    names.erase(std::remove(names.begin(), names.end(), ' '), names.end());
    return names;
}

// Names of the parts in the order in which the pipe was laid, or reversed: the one that begins with the lesser name.
std::string names_of(const PipeLayer& pipe, bool reversed)
{
    std::string names;
    for (const Primitive& part : pipe.parts())
        names =
            reversed ? part.name + (names.empty() ? "" : ",") + names : names + (names.empty() ? "" : ",") + part.name;
    return names;
}

bool is_along(const PipeRun& run, const PipeLayer& pipe)
{
    const std::string names = names_of(run);
    return names == names_of(pipe, false) || names == names_of(pipe, true);
}

void add_all(const PipeLayer& pipe, std::vector<Primitive>& list)
{
    list.insert(list.end(), pipe.parts().begin(), pipe.parts().end());
}

// Each piece begins where the one before it ends; ends of arcs are on their circles; `kink`: the largest angle between
// tangents where pieces meet.
double kink_of(const PipeRun& run, double tolerance)
{
    const auto tangent = [](const CentrePiece& piece, const Vec3d& p) {
        return piece.is_bend() ? normalised(cross(piece.axis, p - piece.centre)) : normalised(piece.to - piece.from);
    };
    double kink = 0;
    for (std::size_t i = 0; i < run.line.size(); ++i) {
        const CentrePiece& piece = run.line[i];
        if (piece.is_bend()) {
            for (const Vec3d& p : {piece.from, piece.to}) {
                EXPECT_NEAR(length(p - piece.centre), piece.radius, tolerance + 1e-9 * piece.radius);
                EXPECT_NEAR(dot(p - piece.centre, piece.axis), 0, tolerance);
            }
            const Vec3d end = piece.centre + pipes::turned(piece.from - piece.centre, piece.axis, piece.angle);
            EXPECT_LT(length(end - piece.to), tolerance + 1e-9 * piece.radius);
        }
        if (i == 0) continue;
        EXPECT_EQ(run.line[i - 1].to, piece.from);
        const double turn = dot(tangent(run.line[i - 1], piece.from), tangent(piece, piece.from));
        kink = std::max(kink, std::acos(std::clamp(turn, -1.0, 1.0)));
    }
    return kink;
}

struct Scale {
    Vec3d origin;
    double metre;
};
constexpr Scale scales[] = {{{0, 0, 0}, 1}, {{500000, 4800000, 100}, 1}, {{0, 0, 0}, 1000}, {{5e8, 4.8e9, 1e5}, 1000}};

TEST(PipeRun, ExactPartsMakeAnExactRun)
{
    Random random(7);
    for (const Scale& scale : scales)
        for (std::size_t bends = 0; bends <= 6; ++bends) {
            const double rounding = 1e-15 * largest_magnitude(scale.origin) * 20 + 1e-12 * scale.metre;
            for (int round = 0; round < 20; ++round) {
                const double radius = uniform(random, 0.02, 0.5) * scale.metre;
                PipeLayer pipe = pipes::random_pipe(random, {}, scale.origin, radius, bends);
                if (bends == 0) {
                    pipe.skip(2 * radius);  // a flange
                    pipe.straight(10 * radius);
                }
                std::vector<Primitive> list = pipe.parts();
                std::shuffle(list.begin(), list.end(), random);
                const std::vector<PipeRun> runs = pipe_runs(list);
                ASSERT_EQ(runs.size(), 1u) << bends;
                const PipeRun& run = runs[0];
                EXPECT_TRUE(is_along(run, pipe)) << names_of(run);
                EXPECT_EQ(run.bends(), bends);
                EXPECT_EQ(run.name, "Pipe run 1");
                EXPECT_FALSE(run.is_closed);
                EXPECT_NEAR(run.radius, radius, 1e-12 * radius);
                EXPECT_EQ(run.radius_error, 0);
                const double missing =
                    std::min(length(run.line.back().to - pipe.place()), length(run.line.front().from - pipe.place()));
                EXPECT_LE(missing, Noise().open * radius * 1.000001);
                EXPECT_NEAR(run.length() + missing, pipe.length(), 100 * rounding);
                EXPECT_LT(kink_of(run, 100 * rounding), 1e-5);
            }
        }
}

TEST(PipeRun, NoisyPartsAreJoinedByTheirErrors)
{
    Random random(11);
    std::size_t pipes = 0, joined = 0;
    double worst = 0;
    for (const Scale& scale : scales)
        for (std::size_t bends = 0; bends <= 6; ++bends)
            for (int round = 0; round < 30; ++round) {
                const double radius = uniform(random, 0.02, 0.5) * scale.metre;
                PipeLayer pipe = pipes::random_pipe(random, usual_noise(), scale.origin, radius, bends);
                if (bends == 0) pipe.straight(10 * radius);
                std::vector<Primitive> list = pipe.parts();
                std::shuffle(list.begin(), list.end(), random);
                const std::vector<PipeRun> runs = pipe_runs(list);
                ++pipes;
                if (runs.size() != 1 || !is_along(runs[0], pipe)) continue;
                ++joined;
                EXPECT_EQ(runs[0].bends(), bends);
                EXPECT_NEAR(runs[0].radius, radius, 5 * runs[0].radius_error);
                EXPECT_GT(runs[0].radius_error, 0);
                EXPECT_LT(runs[0].radius_error, 0.01 * radius);
                const double off = std::fabs(runs[0].length() - pipe.length()) / radius;
                worst = std::max(worst, off / std::sqrt(static_cast<double>(pipe.parts().size())));
                EXPECT_LT(kink_of(runs[0], 1e-9 * largest_magnitude(scale.origin) + 1e-9 * scale.metre), 0.25);
            }
    EXPECT_GE(static_cast<double>(joined), 0.99 * static_cast<double>(pipes)) << joined << " of " << pipes;
    // The last 0.2 radii may not be seen, and each part adds some hundredths of the radius.
    EXPECT_LT(worst, 0.25);
    RecordProperty("joined", std::to_string(joined) + " of " + std::to_string(pipes));
    RecordProperty("worst", std::to_string(worst));
}

TEST(PipeRun, ElbowsWithoutAPipeBetweenThem)
{
    Random random(5);
    for (int round = 0; round < 300; ++round) {
        const double radius = uniform(random, 0.05, 0.2);
        PipeLayer pipe(random, round % 2 ? Noise() : usual_noise(), {500000, 4800000, 100}, pipes::unit_vector(random),
                       radius);
        pipe.straight(10 * radius);
        const Vec3d axis = pipe.any_axis();
        const double first = uniform(random, 30, 90) * degree, second = uniform(random, 30, 90) * degree;
        pipe.elbow(axis, uniform(random, 3, 4) * radius, first);
        if (round % 5 == 0) pipe.skip(radius);
        // In the same plane to the other side, or out of the plane.
        const Vec3d out_of_plane = pipes::turned(axis, pipe.direction(), uniform(random, 40, 140) * degree);
        pipe.elbow(round % 3 ? out_of_plane : -1 * axis, uniform(random, 3, 4) * radius, second);
        pipe.straight(10 * radius);
        const std::vector<PipeRun> runs = pipe_runs(pipe.parts());
        ASSERT_EQ(runs.size(), 1u) << round;
        EXPECT_TRUE(is_along(runs[0], pipe)) << names_of(runs[0]);
        EXPECT_EQ(runs[0].bends(), 2u);
        EXPECT_NEAR(runs[0].length() + 0.1 * radius, pipe.length(), 0.25 * radius) << round;
        const double missing =
            std::min(length(runs[0].line.back().to - pipe.place()), length(runs[0].line.front().from - pipe.place()));
        if (round % 2) EXPECT_NEAR(runs[0].length() + missing, pipe.length(), 1e-6) << round;
    }
}

TEST(PipeRun, BendsThatNoShapeShowsAreAssumed)
{
    Random random(3);
    for (int round = 0; round < 200; ++round) {
        PipeLayer pipe(random, usual_noise(), {1000, 2000, 30}, pipes::unit_vector(random), 0.1);
        pipe.straight(2);
        pipe.elbow(pipe.any_axis(), uniform(random, 2.5, 4) * 0.1, uniform(random, 20, 100) * degree, false);
        pipe.straight(1.5);
        const std::vector<PipeRun> runs = pipe_runs(pipe.parts());
        ASSERT_EQ(runs.size(), 1u) << round;
        EXPECT_EQ(runs[0].bends(), 1u);
        EXPECT_NEAR(runs[0].length(), pipe.length(), 0.06);
        EXPECT_NE(bends_text(runs[0]).find(" degrees, without an elbow in the list"), std::string::npos);
        EXPECT_FALSE(runs[0].line[1].is_measured);
        EXPECT_LT(kink_of(runs[0], 1e-9), 0.2);
    }
}

// Which pipe each part of a run is of: all of one.
bool is_of_one_pipe(const PipeRun& run)
{
    std::set<std::string> pipes;
    for (const Primitive* part : run.parts) pipes.insert(part->name.substr(0, part->name.find('-')));
    return pipes.size() == 1;
}

// Pipes of one radius next to each other in two layers, broken by supports, most of them with elbows at the same place,
// and others across above them.
TEST(PipeRun, PipesOfARackAreNeverMixed)
{
    Random random(23);
    std::size_t pipes = 0, whole = 0;
    for (int rack = 0; rack < 60; ++rack) {
        std::vector<Primitive> list;
        const double radius = uniform(random, 0.05, 0.3), pitch = uniform(random, 2.05, 5) * radius;
        const double layer = uniform(random, 2.05, 6) * radius, bend = uniform(random, 2, 6) * radius;
        std::vector<PipeLayer> laid;
        for (int i = 0; i < 12; ++i) {
            const Vec3d place{500000, 4800000 + pitch * (i % 6), 100 + layer * (i / 6)};
            PipeLayer pipe(random, usual_noise(), place, {1, 0, 0}, radius);
            pipe.name = "rack" + std::to_string(i) + "-";
            pipe.straight(20 * radius);
            if (i % 3 == 0) pipe.skip(uniform(random, 0, 5) * radius);
            pipe.straight(20 * radius);
            if (i % 4 != 3) {
                pipe.elbow(i / 6 ? Vec3d{0, -1, 0} : Vec3d{0, 1, 0}, bend, pi / 2);  // up from above, down from below
                pipe.straight(15 * radius);
            }
            laid.push_back(pipe);
        }
        for (int i = 0; i < 4; ++i) {
            const Vec3d place{500000 + (8 + 6 * i) * radius, 4800000 - 9 * radius, 100 + 2 * layer};
            PipeLayer pipe(random, usual_noise(), place, {0, 1, 0}, radius);
            pipe.name = "across" + std::to_string(i) + "-";
            pipe.straight(3 * radius);
            pipe.straight(5 * radius + 6 * pitch);
            laid.push_back(pipe);
        }
        for (const PipeLayer& pipe : laid) add_all(pipe, list);
        std::shuffle(list.begin(), list.end(), random);
        const std::vector<PipeRun> runs = pipe_runs(list);
        for (const PipeRun& run : runs) EXPECT_TRUE(is_of_one_pipe(run)) << "rack " << rack << ": " << names_of(run);
        for (const PipeLayer& pipe : laid) {
            ++pipes;
            whole += std::any_of(runs.begin(), runs.end(), [&](const PipeRun& run) { return is_along(run, pipe); });
        }
    }
    EXPECT_GE(static_cast<double>(whole), 0.99 * static_cast<double>(pipes)) << whole << " of " << pipes;
}

TEST(PipeRun, ABranchOfATeeIsAPipeOfItsOwn)
{
    Random random(31);
    for (int round = 0; round < 200; ++round) {
        const double radius = 0.1;
        PipeLayer main(random, usual_noise(), {0, 0, 0}, {1, 0, 0}, radius);
        main.name = "main-";
        main.straight(3);
        if (round % 2) main.straight(2);  // its points are interrupted at the tee, or it is one piece
        const Vec3d at{3, 0, 0};
        PipeLayer branch(random, usual_noise(), at + Vec3d{0, uniform(random, 1, 1.3) * radius, 0}, {0, 1, 0}, radius);
        branch.name = "branch-";
        branch.straight(uniform(random, 0.3, 2));
        branch.elbow(branch.any_axis(), 3 * radius, uniform(random, 30, 100) * degree);
        branch.straight(1);
        std::vector<Primitive> list;
        add_all(main, list);
        if (round % 2 == 0) {
            list.back().bounds.to += 2;  // all of it
            if (dot(list.back().fit.shape.axis, {1, 0, 0}) < 0) {
                list.back().bounds.to -= 2;
                list.back().bounds.from -= 2;
            }
        }
        add_all(branch, list);
        std::shuffle(list.begin(), list.end(), random);
        const std::vector<PipeRun> runs = pipe_runs(list);
        EXPECT_EQ(runs.size(), round % 2 ? 2u : 1u) << round;
        for (const PipeRun& run : runs) EXPECT_TRUE(is_of_one_pipe(run)) << names_of(run);
    }
}

// A pipe keeps its straight continuation although an elbow branches off at the same end; where both
// straight pipes have elbows of their own, each keeps its elbow.
TEST(PipeRun, AStraightContinuationIsPreferredToABranchingElbow)
{
    Random random(37);
    for (const bool facing : {false, true}) {
        PipeLayer main(random, {}, {0, 0, 0}, {1, 0, 0}, 0.1), branch = main;
        main.name = "main-";
        main.straight(2);
        PipeLayer elbow(random, {}, main.place(), {1, 0, 0}, 0.1);
        elbow.name = facing ? "main-x" : "branch-";
        elbow.elbow({0, 0, 1}, 0.25, pi / 2);
        elbow.straight(1);
        PipeLayer other(random, {}, {4.55, 0, 0}, {-1, 0, 0}, 0.1);
        other.name = facing ? "other-" : "main-y";
        other.straight(2);
        if (facing) {
            other.elbow({0, 0, -1}, 0.25, pi / 2);
            other.straight(1);
        }
        std::vector<Primitive> list;
        for (const PipeLayer* pipe : {&main, &elbow, &other}) add_all(*pipe, list);
        const std::vector<PipeRun> runs = pipe_runs(list);
        EXPECT_EQ(runs.size(), 2u) << facing;
        for (const PipeRun& run : runs) EXPECT_TRUE(is_of_one_pipe(run)) << facing << names_of(run);
    }
}

TEST(PipeRun, PipesOfOtherSizesBehindAReducerAreNotJoined)
{
    Random random(41);
    for (int round = 0; round < 200; ++round) {
        const double radius = 0.1, ratio = uniform(random, 1.07, 1.6);
        Noise noise = usual_noise();
        noise.radius = round % 2 ? 0.004 : 0.05;  // nor where radii are hardly known
        PipeLayer one(random, noise, {0, 0, 0}, {1, 0, 0}, radius);
        one.straight(2);
        std::vector<Primitive> list = one.parts();
        list[0].fit.shape.radius = radius;
        PipeLayer other(random, noise, {2.2, 0, 0}, {1, 0, 0}, radius * ratio);
        other.straight(2);
        add_all(other, list);
        list[1].fit.shape.radius = radius * ratio;
        EXPECT_TRUE(pipe_runs(list).empty()) << ratio;
    }
}

TEST(PipeRun, ARingMainIsClosed)
{
    Random random(2);
    PipeLayer pipe(random, {}, {10, 20, 30}, {1, 0, 0}, 0.1);
    for (int side = 0; side < 4; ++side) {
        pipe.straight(side % 2 ? 2 : 3);
        pipe.elbow({0, 0, 1}, 0.3, pi / 2);
    }
    std::vector<Primitive> list = pipe.parts();
    const std::vector<PipeRun> runs = pipe_runs(list);
    ASSERT_EQ(runs.size(), 1u);
    EXPECT_TRUE(runs[0].is_closed);
    EXPECT_EQ(runs[0].parts.size(), 8u);
    EXPECT_NEAR(runs[0].length(), pipe.length(), 1e-9);
    EXPECT_LT(length(runs[0].line.back().to - runs[0].line.front().from), 1e-12);
    const std::vector<Vec3d> points = centre_points(runs[0]);
    EXPECT_GT(length(points.back() - points.front()), 0.01);
}

TEST(PipeRun, WhatIsHiddenUnboundedOrAloneIsNoRun)
{
    Random random(2);
    PipeLayer pipe(random, {}, {0, 0, 0}, {1, 0, 0}, 0.1);
    pipe.straight(1);
    pipe.elbow({0, 0, 1}, 0.3, pi / 2);
    std::vector<Primitive> list = pipe.parts();
    EXPECT_EQ(pipe_runs(list).size(), 1u);
    for (int which = 0; which < 4; ++which) {
        std::vector<Primitive> changed = list;
        if (which == 0) changed[0].hidden = true;
        if (which == 1) changed[0].bounds.to = changed[0].bounds.from;
        if (which == 2) changed[1].bounds.end = changed[1].bounds.begin + 2 * pi;
        if (which == 3) changed[1].fit.verdict = FitVerdict::refused;
        EXPECT_TRUE(pipe_runs(changed).empty()) << which;
    }
    EXPECT_TRUE(pipe_runs(std::vector<Primitive>()).empty());
}

TEST(PipeRun, NeitherOrderNorDirectionMatter)
{
    Random random(19);
    for (int round = 0; round < 20; ++round) {
        std::vector<Primitive> list;
        for (int i = 0; i < 5; ++i) {
            PipeLayer pipe = pipes::random_pipe(random, usual_noise(), {100.0 * i, 0, 0}, 0.1, 3);
            add_all(pipe, list);
            for (std::size_t k = list.size() - pipe.parts().size(); k < list.size(); ++k)
                list[k].name = std::to_string(i) + "-" + list[k].name;
        }
        const auto found = [&] {
            std::multiset<std::string> all;
            for (const PipeRun& run : pipe_runs(list)) {
                std::vector<std::string> names;
                for (const Primitive* part : run.parts) names.push_back(part->name);
                if (names.front() > names.back()) std::reverse(names.begin(), names.end());
                std::ostringstream text;
                for (const std::string& name : names) text << name << ' ';
                text << static_cast<long long>(std::llround(1e9 * run.length()));
                all.insert(text.str());
            }
            return all;
        };
        const auto before = found();
        EXPECT_GE(before.size(), 5u);
        std::shuffle(list.begin(), list.end(), random);
        EXPECT_EQ(found(), before);
    }
}

TEST(PipeRun, APolylineFollowsArcsWithinTheChord)
{
    Random random(13);
    const PipeLayer pipe = pipes::random_pipe(random, {}, {500000, 4800000, 100}, 0.1, 4);
    const std::vector<PipeRun> runs = pipe_runs(pipe.parts());
    ASSERT_EQ(runs.size(), 1u);
    std::size_t usual = centre_points(runs[0]).size();
    for (const double chord : {0.01, 0.001, 0.0001}) {
        const std::vector<Vec3d> points = centre_points(runs[0], chord);
        double sum = 0, farthest = 0;
        for (std::size_t i = 1; i < points.size(); ++i) {
            sum += length(points[i] - points[i - 1]);
            const Vec3d middle = 0.5 * (points[i] + points[i - 1]);
            double nearest = infinity;
            for (const CentrePiece& piece : runs[0].line) {
                const Vec3d d = middle - (piece.is_bend() ? piece.centre : piece.from);
                const Vec3d along = normalised(piece.to - piece.from);
                const double off = piece.is_bend() ? std::hypot(dot(d, piece.axis), length(d) - piece.radius)
                                                   : length(d - dot(d, along) * along);
                nearest = std::min(nearest, off);
            }
            farthest = std::max(farthest, nearest);
        }
        EXPECT_LE(farthest, chord * 1.001);
        EXPECT_GT(farthest, chord / 20);
        EXPECT_LT(sum, runs[0].length());
        EXPECT_GT(sum, runs[0].length() * (1 - 3 * chord));
        if (chord < 0.001) EXPECT_GT(points.size(), usual);
    }
    for (const double chord : {-1.0, not_a_number, infinity}) EXPECT_THROW(centre_points(runs[0], chord), Error);
}

TEST(PipeRun, TextsSayWhatARunIs)
{
    Random random(2);
    Noise whole;
    whole.open = 0;
    PipeLayer pipe(random, whole, {0, 0, 0}, {1, 0, 0}, 0.1);
    pipe.straight(1);
    pipe.elbow({0, 0, 1}, 0.3, pi / 2);
    pipe.straight(1);
    pipe.elbow({0, 0, 1}, 0.3, pi / 4);
    std::vector<Primitive> list = pipe.parts();
    EXPECT_EQ(bends_text(pipe_runs(list)[0]), "2 bends of 90 and 45 degrees");
    EXPECT_EQ(parts_text(pipe_runs(list)[0]), "a0, a1, a2, a3");
    EXPECT_EQ(doubt_text(pipe_runs(list)[0]), "");
    list[1].fit.verdict = FitVerdict::doubtful;
    EXPECT_EQ(doubt_text(pipe_runs(list)[0]), "'a1' is doubtful");
    list[3].fit.verdict = FitVerdict::doubtful;
    EXPECT_EQ(doubt_text(pipe_runs(list)[0]), "'a1' and 1 other are doubtful");
    list.resize(2);
    EXPECT_EQ(bends_text(pipe_runs(list)[0]), "1 bend of 90 degrees");
    std::swap(list[0], list[1]);
    EXPECT_EQ(parts_text(pipe_runs(list)[0]), "a1, a0") << "from the end that the list has first";
}

TEST(PipingTuning, ValuesAreFoundByTheirNames)
{
    std::set<std::string> names;
    for (const TunedValue& value : piping_tuned_values()) names.insert(value.name());
    EXPECT_EQ(names.size(), sizeof(PipingTuning) / sizeof(double));
    EXPECT_EQ(names.count("piping.joints.max_gap"), 1u);
}

}  // namespace
}  // namespace pcm
