#include "pcm/piping/pipe_run.h"

#include "pcm/cloud/numbers.h"
#include "pcm/piping/pipe_joints.h"
#include "pcm/piping/run_errors.h"
#include "pcm/piping/tuning.h"
#include "pcm/shapes/axis_mesh.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace pcm {
namespace {

using piping::angle_between;
using piping::EndIndex;
using piping::PipeJoint;

constexpr double least_turn = 0.002;  // radians: of less than that a bend's radius says nothing

// A place of a centre line, and its unit tangent there.
struct Passage {
    Vec3d place{}, along{};
};

void add_straight(const Vec3d& from, const Vec3d& to, bool is_measured, std::vector<CentrePiece>& line)
{
    if (from == to) return;
    CentrePiece piece;
    piece.from = from;
    piece.to = to;
    piece.is_measured = is_measured;
    line.push_back(piece);
}

// The arc through both places whose tangents differ as theirs do: the turn is theirs about `axis`, the radius follows
// from the chord c, c = 2 radius sin(turn / 2).
void add_arc(const Passage& from, const Passage& to, const Vec3d& axis, bool is_measured,
             std::vector<CentrePiece>& line)
{
    double turn = std::atan2(dot(cross(from.along, to.along), axis), dot(from.along, to.along));
    if (turn < 0) turn += 2 * pi;
    const Vec3d chord = to.place - from.place;
    const double distance = length(chord);
    if (!(distance > 0) || turn < least_turn || turn > 2 * pi - least_turn)
        return add_straight(from.place, to.place, is_measured, line);
    CentrePiece piece;
    piece.from = from.place;
    piece.to = to.place;
    piece.angle = turn;
    piece.radius = distance / (2 * std::sin(turn / 2));
    const Vec3d x = chord / distance;
    piece.axis = normalised(axis - dot(axis, x) * x);
    piece.centre = from.place + 0.5 * chord + (distance / (2 * std::tan(turn / 2))) * cross(piece.axis, x);
    piece.is_measured = is_measured;
    line.push_back(piece);
}

// What lies between two parts that a joint brings together.
void add_between(const PipeJoint& joint, std::vector<CentrePiece>& line)
{
    const Vec3d normal = cross(joint.leaves, joint.enters);
    if (length(normal) > 0)
        add_arc({joint.at_a, joint.leaves}, {joint.at_b, joint.enters}, normalised(normal), false, line);
    else
        add_straight(joint.at_a, joint.at_b, false, line);
}

// Tubes of primitives, and the chains that joints make of them.
class Chains {
public:
    explicit Chains(const std::vector<const Primitive*>& primitives)
    {
        for (const Primitive* primitive : primitives) {
            if (primitive->hidden || !primitive->fit.has_shape()) continue;
            const Shape& shape = primitive->fit.shape;
            const auto tube = traits_of(shape.kind).tube(shape, primitive->bounds, primitive->fit.errors);
            if (!tube) continue;
            tubes_.push_back(*tube);
            primitives_.push_back(primitive);
        }
        joints_ = piping::pipe_joints(tubes_);
        joint_of_.resize(2 * tubes_.size(), nullptr);
        for (const PipeJoint& joint : joints_) joint_of_[joint.a] = joint_of_[joint.b] = &joint;
    }

    std::vector<PipeRun> runs() const
    {
        std::vector<PipeRun> runs;
        std::vector<bool> seen(tubes_.size(), false);
        for (std::size_t tube = 0; tube < tubes_.size(); ++tube) {
            if (seen[tube] || (!joint_of_[2 * tube] && !joint_of_[2 * tube + 1])) continue;
            const EndIndex one = first_end(2 * tube), other = first_end(2 * tube + 1);
            PipeRun run = run_from(one / 2 <= other / 2 ? one : other, seen);
            run.name = "Pipe run " + std::to_string(runs.size() + 1);
            runs.push_back(std::move(run));
        }
        return runs;
    }

private:
    static EndIndex other_end(EndIndex end) { return end ^ 1; }
    static EndIndex partner(const PipeJoint& joint, EndIndex end) { return joint.a == end ? joint.b : joint.a; }

    // The free end of the chain on the side of this one; itself where the chain is closed.
    EndIndex first_end(EndIndex start) const
    {
        EndIndex end = start;
        while (const PipeJoint* joint = joint_of_[end]) {
            end = other_end(partner(*joint, end));
            if (end == start) break;
        }
        return end;
    }

    // A joint as it is passed from this end on.
    static PipeJoint passed(const PipeJoint& joint, EndIndex from)
    {
        if (joint.a == from) return joint;
        return {joint.b,           joint.a,           joint.at_b,   joint.at_a,
                -1 * joint.enters, -1 * joint.leaves, joint.misfit, joint.rank};
    }

    PipeRun run_from(EndIndex first, std::vector<bool>& seen) const
    {
        PipeRun run;
        std::vector<EndIndex> ins;
        run.is_closed = joint_of_[first] != nullptr;
        EndIndex in = first;
        do {
            seen[in / 2] = true;
            run.parts.push_back(primitives_[in / 2]);
            ins.push_back(in);
            add_part(in, run.line);
            const PipeJoint* const next = joint_of_[other_end(in)];
            if (!next) break;
            add_between(passed(*next, other_end(in)), run.line);
            in = partner(*next, other_end(in));
        } while (in != first);
        set_errors(ins, run);
        return run;
    }

    // The centre line of a part from one of its ends, or from where a joint enters it, to the other.
    void add_part(EndIndex in, std::vector<CentrePiece>& line) const
    {
        const Tube& tube = tubes_[in / 2];
        const EndIndex out = other_end(in);
        const TubeEnd &begin = tube.ends[in % 2], &end = tube.ends[out % 2];
        Passage from{begin.place, -1 * begin.out}, to{end.place, end.out};
        if (joint_of_[in]) {
            const PipeJoint joint = passed(*joint_of_[in], partner(*joint_of_[in], in));
            from = {joint.at_b, joint.enters};
        }
        if (joint_of_[out]) {
            const PipeJoint joint = passed(*joint_of_[out], out);
            to = {joint.at_a, joint.leaves};
        }
        if (tube.is_straight())
            add_straight(from.place, to.place, true, line);
        else
            add_arc(from, to, (in % 2 == 0 ? 1.0 : -1.0) * tube.axis, true, line);
    }

    // The length's error is known where all errors of the parts are.
    void set_errors(const std::vector<EndIndex>& ins, PipeRun& run) const
    {
        std::vector<const Tube*> tubes;
        for (const EndIndex in : ins) tubes.push_back(&tubes_[in / 2]);
        const piping::ValueWithError radius = piping::run_radius(tubes);
        run.radius = radius.value;
        run.radius_error = radius.error;
        if (!(radius.error > 0)) return;
        std::vector<piping::RunBend> bends;
        std::array<double, 2> free_ends{};
        for (std::size_t i = 0; i < ins.size(); ++i) {
            const Tube& tube = *tubes[i];
            const PipeJoint *const before = joint_of_[ins[i]], *const next = joint_of_[other_end(ins[i])];
            const double end_error = piping::end_error(*run.parts[i], tube);
            if (!before) free_ends[0] = end_error;
            if (!next) free_ends[1] = end_error;
            if (!tube.is_straight()) bends.push_back(bend_of(tube, before, next));
            if (next && next->is_assumed_bend()) bends.push_back(assumed_bend(*next, radius.value));
        }
        run.length_error = piping::length_error(bends, free_ends);
    }

    // Straight parts on both sides hold the arc; an elbow next to another one has its own errors alone.
    piping::RunBend bend_of(const Tube& elbow, const PipeJoint* before, const PipeJoint* next) const
    {
        piping::RunBend bend;
        bend.turn = elbow.arc;  // longer than the bend where it has points of pipes
        if (before && next) bend.turn = angle_between(tangent_into(elbow, *before), -1 * tangent_into(elbow, *next));
        bend.arc = elbow.bend * bend.turn;
        bend.tangent_error = elbow.place_error;
        for (const PipeJoint* joint : {before, next}) {
            if (!joint) continue;
            const Tube &a = tubes_[joint->a / 2], &b = tubes_[joint->b / 2];
            const Tube& other = &a == &elbow ? b : a;
            if (other.is_straight()) add_tangent(other, elbow.bend, bend);
        }
        return bend;
    }

    // Unit tangent at a joint of the elbow that points into it.
    Vec3d tangent_into(const Tube& elbow, const PipeJoint& joint) const
    {
        return &tubes_[joint.b / 2] == &elbow ? joint.enters : -1 * joint.leaves;
    }

    // Pipes end before the bend begins, or have points of it, by up to what joints allow of overlaps.
    piping::RunBend assumed_bend(const PipeJoint& joint, double radius) const
    {
        piping::RunBend bend;
        bend.turn = angle_between(joint.leaves, joint.enters);
        bend.tangent_error = piping_tuning().joints.max_overlap * radius;
        const double bend_radius = length(joint.at_b - joint.at_a) / (2 * std::sin(bend.turn / 2));
        bend.arc = bend_radius * bend.turn;
        for (const EndIndex end : {joint.a, joint.b}) add_tangent(tubes_[end / 2], bend_radius, bend);
        return bend;
    }

    static void add_tangent(const Tube& straight, double bend_radius, piping::RunBend& bend)
    {
        bend.place_error = std::hypot(bend.place_error, straight.place_error);
        bend.direction_error = std::hypot(bend.direction_error, straight.angle_error * bend_radius);
    }

    std::vector<Tube> tubes_;
    std::vector<const Primitive*> primitives_;  // the list's, which parts are chosen from
    std::vector<PipeJoint> joints_;
    std::vector<const PipeJoint*> joint_of_;  // indexed by EndIndex; null: the end is free
};

}  // namespace

double CentrePiece::length() const { return is_bend() ? radius * angle : pcm::length(to - from); }

double PipeRun::length() const
{
    double sum = 0;
    for (const CentrePiece& piece : line) sum += piece.length();
    return sum;
}

std::size_t PipeRun::bends() const
{
    return static_cast<std::size_t>(
        std::count_if(line.begin(), line.end(), [](const CentrePiece& piece) { return piece.is_bend(); }));
}

std::vector<PipeRun> pipe_runs(const std::vector<const Primitive*>& primitives) { return Chains(primitives).runs(); }

std::vector<PipeRun> pipe_runs(const std::vector<Primitive>& primitives)
{
    std::vector<const Primitive*> all;
    for (const Primitive& primitive : primitives) all.push_back(&primitive);
    return pipe_runs(all);
}

std::vector<Vec3d> centre_points(const PipeRun& run, double chord)
{
    if (!(chord >= 0 && std::isfinite(chord)))
        throw Error(ErrorCode::invalid_argument, {}, "the chord tolerance is not 0 or above");
    if (chord == 0) chord = run.radius / 100;
    std::vector<Vec3d> points;
    for (const CentrePiece& piece : run.line) {
        points.push_back(piece.from);
        if (!piece.is_bend()) continue;
        const std::size_t count = shapes::segments(piece.radius, chord, piece.angle);
        const Vec3d u = piece.from - piece.centre, v = cross(piece.axis, u);
        for (std::size_t i = 1; i < count; ++i) {
            const double angle = piece.angle * static_cast<double>(i) / static_cast<double>(count);
            points.push_back(piece.centre + std::cos(angle) * u + std::sin(angle) * v);
        }
    }
    if (!run.is_closed && !run.line.empty()) points.push_back(run.line.back().to);
    return points;
}

std::string bends_text(const PipeRun& run)
{
    std::string angles;
    std::size_t left = run.bends(), measured = 0;
    if (left == 0) return "no bends";
    const std::string count = std::to_string(left) + (left == 1 ? " bend of " : " bends of ");
    for (const CentrePiece& piece : run.line) {
        if (!piece.is_bend()) continue;
        angles += brief(piece.angle / degree);
        measured += piece.is_measured;
        if (--left > 0) angles += left == 1 ? " and " : ", ";
    }
    const std::size_t assumed = run.bends() - measured;
    if (assumed == 0) return count + angles + " degrees";
    return count + angles + " degrees, " + (measured == 0 ? "" : std::to_string(assumed) + " of them ") +
           "without an elbow in the list";
}

std::string parts_text(const PipeRun& run)
{
    std::string names;
    for (const Primitive* part : run.parts) names += (names.empty() ? "" : ", ") + part->name;
    return names;
}

std::string doubt_text(const PipeRun& run)
{
    std::size_t doubtful = 0;
    std::string first;
    for (const Primitive* part : run.parts)
        if (part->fit.verdict != FitVerdict::good && doubtful++ == 0) first = "'" + part->name + "'";
    if (doubtful == 0) return {};
    if (doubtful == 1) return first + " is doubtful";
    return first + " and " + std::to_string(doubtful - 1) + (doubtful == 2 ? " other" : " others") + " are doubtful";
}

}  // namespace pcm
