#include "pcm/piping/pipe_joints.h"

#include "pcm/cloud/numbers.h"
#include "pcm/piping/tuning.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace pcm::piping {
namespace {

// Kinds of joints in the order in which they are taken; `straight_on` is what a straight one becomes where an elbow
// continues one of its ends and not the other: the elbow is then the branch of a tee.
enum Rank : int { straight_on, elbow, straight, corner };

const Tube& tube_of(const std::vector<Tube>& tubes, EndIndex end) { return tubes[end / 2]; }
const TubeEnd& end_of(const std::vector<Tube>& tubes, EndIndex end) { return tubes[end / 2].ends[end % 2]; }

double centre_length(const Tube& tube)
{
    return tube.is_straight() ? length(tube.ends[1].place - tube.ends[0].place) : tube.bend * tube.arc;
}

// A line that is tangent to the centre lines of both tubes.
struct Tangent {
    Vec3d point{}, direction{};
};

// How far along the centre line two tubes may have points of each other. Where a pipe of radius r becomes an elbow of
// radius R their surfaces have a curve in common, x^2 = 4 R r cos(a), x along the pipe, a about it from the inside of
// the bend.
double overlap_of(const Tube& a, const Tube& b)
{
    const double radius = (a.radius + b.radius) / 2;
    if (a.is_straight() && b.is_straight()) return piping_tuning().joints.max_overlap * radius;
    const double bend = a.is_straight() ? b.bend : b.is_straight() ? a.bend : std::min(a.bend, b.bend);
    return 2 * std::sqrt(bend * radius);
}

// What two tubes' deviations from one pipe are held against.
class Trial {
public:
    Trial(const Tube& a, const Tube& b)
        : tuned_(piping_tuning().joints),
          radius_((a.radius + b.radius) / 2),
          offset_(limit(tuned_.offset_share * radius_, std::hypot(a.place_error, b.place_error),
                        tuned_.max_offset * radius_)),
          angle_(limit(tuned_.angle, std::hypot(a.angle_error, b.angle_error), tuned_.max_angle)),
          overlap_(std::min({overlap_of(a, b), centre_length(a) / 2, centre_length(b) / 2}))
    {
        test(a.radius - b.radius, limit(tuned_.radius_share * radius_, std::hypot(a.radius_error, b.radius_error),
                                        tuned_.max_radius_share * radius_));
    }

    bool holds() const { return misfit_ <= 1; }
    double misfit() const { return misfit_; }
    double radius() const { return radius_; }

    // Distance that centre lines miss each other by.
    void offset(double value) { test(value, offset_); }
    void angle(double value) { test(value, angle_); }
    // What is open between measured ends along the centre line; below 0: they overlap.
    void gap(double value) { test(value, value < 0 ? overlap_ : tuned_.max_gap * radius_); }
    void open_arc(double value, double bend)
    {
        test(value, value < 0 ? overlap_ / bend : std::min(tuned_.max_open_arc, tuned_.max_gap * radius_ / bend));
    }
    // What is not a number is refused.
    void test(double value, double limit)
    {
        const double share = std::fabs(value) / limit;
        misfit_ = share <= 1 ? std::max(misfit_, share) : infinity;
    }
    void refuse() { misfit_ = infinity; }

private:
    double limit(double share, double error, double most) const
    {
        return std::min(share + tuned_.error_sigmas * error, most);
    }

    const JointTuning& tuned_;
    double radius_, offset_, angle_, overlap_;
    double misfit_ = 0;
};

// Where the line, which runs towards the elbow, touches the circle that the elbow's centre line follows: next to its
// centre.
Vec3d touching_place(const Tube& tube, const TubeEnd& end, const Tangent& line, Trial& trial)
{
    const Vec3d place = line.point + dot(tube.centre - line.point, line.direction) * line.direction;
    const Vec3d away = place - tube.centre, measured = end.place - tube.centre;
    trial.angle(std::asin(std::clamp(dot(line.direction, tube.axis), -1.0, 1.0)));
    trial.offset(dot(away, tube.axis));
    trial.offset(length(away) - tube.bend);
    // The arc is open from its measured end to there, positive in the direction that leads out of it.
    const double turn = std::atan2(dot(cross(measured, away), tube.axis), dot(measured, away));
    const double outwards = dot(cross(tube.axis, measured), end.out) > 0 ? 1 : -1;
    trial.open_arc(outwards * turn, tube.bend);
    if (dot(line.direction, outwards * cross(tube.axis, away)) > 0) trial.refuse();  // from its other side
    return place;
}

std::optional<PipeJoint> joint_of(Rank rank, const Trial& trial, const Vec3d& at_a, const Vec3d& at_b,
                                  const Vec3d& leaves, const Vec3d& enters)
{
    if (!trial.holds()) return {};
    PipeJoint joint;
    joint.at_a = at_a;
    joint.at_b = at_b;
    joint.leaves = leaves;
    joint.enters = enters;
    joint.misfit = trial.misfit();
    joint.rank = rank;
    return joint;
}

// Two pipes with one axis.
std::optional<PipeJoint> straight_joint(const TubeEnd& a, const TubeEnd& b, Trial trial)
{
    const Vec3d direction = normalised(a.out - b.out), between = b.place - a.place;
    const double along = dot(between, direction);
    trial.angle(angle_between(a.out, -1 * b.out));
    trial.offset(length(between - along * direction));
    trial.gap(along);
    if (along > trial.radius()) return joint_of(straight, trial, a.place, b.place, direction, direction);
    const Vec3d middle = a.place + 0.5 * between;  // they overlap, or what is between them is short
    return joint_of(straight, trial, middle, middle, direction, direction);
}

// Two pipes whose axes meet beyond both ends, joined by an arc that touches them at the nearer end.
std::optional<PipeJoint> corner_joint(const TubeEnd& a, const TubeEnd& b, Trial trial)
{
    const CornerTuning& tuned = piping_tuning().corners;
    const double turn = angle_between(a.out, -1 * b.out);
    if (!(turn >= tuned.min_turn && turn <= tuned.max_turn)) return {};
    const AxesMeeting meeting = axes_meeting(a, b);
    const double to_a = meeting.to_a, to_b = meeting.to_b;
    const double least = std::min(to_a, to_b);
    if (!(least >= tuned.min_bend * trial.radius() * std::tan(turn / 2))) return {};
    trial.offset(meeting.apart);
    trial.gap(to_a);
    trial.gap(to_b);
    trial.test(to_a - to_b, tuned.max_difference * trial.radius());
    return joint_of(corner, trial, a.place + (to_a - least) * a.out, b.place + (to_b - least) * b.out, a.out,
                    -1 * b.out);
}

// A pipe that touches the circle of an elbow.
std::optional<PipeJoint> elbow_joint(const TubeEnd& pipe, const Tube& bent, const TubeEnd& end, Trial trial)
{
    const Vec3d place = touching_place(bent, end, {pipe.place, pipe.out}, trial);
    trial.gap(dot(place - pipe.place, pipe.out));
    return joint_of(elbow, trial, place, place, pipe.out, pipe.out);
}

// Common tangent of two circles on one plane, near `line`.
Tangent tangent_in_plane(const Tube& a, const Tube& b, const Tangent& line)
{
    const Vec3d normal = normalised(a.axis + (dot(a.axis, b.axis) < 0 ? -1.0 : 1.0) * b.axis);
    const Vec3d left = normalised(cross(normal, line.direction));
    const auto signed_bend = [&](const Tube& tube) {
        return std::copysign(tube.bend, dot(left, tube.centre - line.point));  // above 0: its centre is to the left
    };
    const double bend_a = signed_bend(a), bend_b = signed_bend(b);
    Vec3d between = b.centre - a.centre;
    between = between - dot(between, normal) * normal;
    const double distance = length(between);
    if (distance < (a.bend + b.bend) / 4) return line;  // nearly one circle: any of its tangents
    // left . (b.centre - a.centre) is the difference of their distances from the line.
    const double along = std::clamp((bend_b - bend_a) / distance, -1.0, 1.0);
    const Vec3d x = between / distance, y = cross(normal, x);
    const Vec3d new_left = along * x + std::copysign(std::sqrt(1 - along * along), dot(left, y)) * y;
    const Vec3d middle = 0.5 * ((a.centre - bend_a * new_left) + (b.centre - bend_b * new_left));
    return {middle, cross(new_left, normal)};
}

// Common tangent of the circles of two elbows, near where their measured ends are.
Tangent common_tangent(const Tube& a, const TubeEnd& end_a, const Tube& b, const TubeEnd& end_b)
{
    constexpr double least_sine = 0.3;  // sine of the angle between planes whose line of intersection is known well
    const Tangent line{0.5 * (end_a.place + end_b.place), normalised(end_a.out - end_b.out)};
    const Vec3d both = cross(a.axis, b.axis);
    const double sine = length(both);
    if (sine < least_sine) return tangent_in_plane(a, b, line);
    // line.point + x a.axis + y b.axis lies on both planes.
    const double c = dot(a.axis, b.axis);
    const double from_a = dot(a.axis, a.centre - line.point), from_b = dot(b.axis, b.centre - line.point);
    const double x = (from_a - c * from_b) / (1 - c * c), y = (from_b - c * from_a) / (1 - c * c);
    return {line.point + x * a.axis + y * b.axis, std::copysign(1 / sine, dot(both, line.direction)) * both};
}

// Two elbows without a pipe between them.
std::optional<PipeJoint> double_elbow(const Tube& a, const TubeEnd& end_a, const Tube& b, const TubeEnd& end_b,
                                      Trial trial)
{
    const Tangent line = common_tangent(a, end_a, b, end_b);
    const Vec3d at_a = touching_place(a, end_a, {line.point, -1 * line.direction}, trial);
    const Vec3d at_b = touching_place(b, end_b, line, trial);
    trial.gap(dot(at_b - at_a, line.direction));
    return joint_of(elbow, trial, at_a, at_b, line.direction, line.direction);
}

PipeJoint reversed(PipeJoint joint)
{
    std::swap(joint.at_a, joint.at_b);
    std::swap(joint.leaves, joint.enters);
    joint.leaves = -1 * joint.leaves;
    joint.enters = -1 * joint.enters;
    return joint;
}

void add_joints(const std::vector<Tube>& tubes, EndIndex i, EndIndex j, std::vector<PipeJoint>& joints)
{
    const Tube &a = tube_of(tubes, i), &b = tube_of(tubes, j);
    const Trial trial(a, b);
    if (!trial.holds()) return;
    const TubeEnd &end_a = end_of(tubes, i), &end_b = end_of(tubes, j);
    const auto add = [&](std::optional<PipeJoint> joint) {
        if (!joint) return;
        joint->a = i;
        joint->b = j;
        joints.push_back(*joint);
    };
    if (a.is_straight() && b.is_straight()) {
        add(straight_joint(end_a, end_b, trial));
        add(corner_joint(end_a, end_b, trial));
    } else if (a.is_straight()) {
        add(elbow_joint(end_a, b, end_b, trial));
    } else if (b.is_straight()) {
        const auto joint = elbow_joint(end_b, a, end_a, trial);
        if (joint) add(reversed(*joint));
    } else {
        add(double_elbow(a, end_a, b, end_b, trial));
    }
}

// All that hold, from ends that are near each other along x.
std::vector<PipeJoint> candidates(const std::vector<Tube>& tubes)
{
    std::vector<EndIndex> order(2 * tubes.size());
    for (EndIndex end = 0; end < order.size(); ++end) order[end] = end;
    std::sort(order.begin(), order.end(),
              [&](EndIndex i, EndIndex j) { return end_of(tubes, i).place[0] < end_of(tubes, j).place[0]; });
    const JointTuning& tuned = piping_tuning().joints;
    std::vector<PipeJoint> joints;
    for (std::size_t first = 0; first < order.size(); ++first) {
        const EndIndex i = order[first];
        // Where axes meet, either end may be a gap away from there.
        const double reach = 2 * tuned.max_gap * (1 + tuned.max_radius_share) * tube_of(tubes, i).radius;
        for (std::size_t second = first + 1; second < order.size(); ++second) {
            const EndIndex j = order[second];
            const Vec3d &p = end_of(tubes, i).place, &q = end_of(tubes, j).place;
            if (q[0] - p[0] > reach) break;
            if (i / 2 != j / 2 && squared_distance(p, q) <= square(reach)) add_joints(tubes, i, j, joints);
        }
    }
    return joints;
}

void prefer_straight_on(std::size_t ends, std::vector<PipeJoint>& joints)
{
    std::vector<bool> has_elbow(ends, false);
    for (const PipeJoint& joint : joints)
        if (joint.rank == elbow) has_elbow[joint.a] = has_elbow[joint.b] = true;
    for (PipeJoint& joint : joints)
        if (joint.rank == straight && !(has_elbow[joint.a] && has_elbow[joint.b])) joint.rank = straight_on;
}

}  // namespace

double angle_between(const Vec3d& a, const Vec3d& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

bool PipeJoint::is_assumed_bend() const { return rank == corner; }

AxesMeeting axes_meeting(const TubeEnd& a, const TubeEnd& b)
{
    AxesMeeting meeting;
    meeting.turn = angle_between(a.out, -1 * b.out);
    const Vec3d between = b.place - a.place;
    const double c = dot(a.out, b.out);
    meeting.to_a = (dot(between, a.out) - c * dot(between, b.out)) / (1 - c * c);
    meeting.to_b = c * meeting.to_a - dot(between, b.out);
    meeting.apart = length(between + meeting.to_b * b.out - meeting.to_a * a.out);
    return meeting;
}

std::vector<PipeJoint> pipe_joints(const std::vector<Tube>& tubes)
{
    std::vector<PipeJoint> joints = candidates(tubes);
    prefer_straight_on(2 * tubes.size(), joints);
    std::sort(joints.begin(), joints.end(), [](const PipeJoint& one, const PipeJoint& other) {
        return std::tie(one.rank, one.misfit, one.a, one.b) < std::tie(other.rank, other.misfit, other.a, other.b);
    });
    std::vector<bool> taken(2 * tubes.size(), false);
    const auto is_taken = [&](const PipeJoint& joint) {
        if (taken[joint.a] || taken[joint.b]) return true;
        taken[joint.a] = taken[joint.b] = true;
        return false;
    };
    joints.erase(std::remove_if(joints.begin(), joints.end(), is_taken), joints.end());
    return joints;
}

}  // namespace pcm::piping
