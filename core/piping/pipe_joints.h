// Which ends of pipes continue each other: what pipe_runs() (pipe_run.h) is made of.
#pragma once

#include "pcm/shapes/tube.h"

#include <cstddef>
#include <vector>

namespace pcm::piping {

// An end of a tube: 2 * the tube's index, + 1 for its second end.
using EndIndex = std::size_t;

struct PipeJoint {
    EndIndex a = 0, b = 0;
    // Where the centre line leaves the tube of `a`, and where it enters that of `b`: one place, the ends of a straight
    // line, or of an arc that no shape has.
    Vec3d at_a{}, at_b{};
    Vec3d leaves{}, enters{};  // unit tangents there, from `a` to `b`
    double misfit = 0;         // the largest deviation, in what is allowed of it: 0 to 1
    int rank = 0;              // lower ones are preferred

    // Whether the arc between two pipes is one that no shape shows.
    bool is_assumed_bend() const;
};

// Between two unit vectors, 0 to pi.
double angle_between(const Vec3d& a, const Vec3d& b);

// Where the axes of two straight tubes come nearest to each other beyond these ends: a.place + to_a a.out and
// b.place + to_b b.out, `apart` from each other. The ends must not be parallel.
struct AxesMeeting {
    double turn = 0;  // angle between a.out and -b.out, 0 to pi
    double to_a = 0, to_b = 0, apart = 0;
};
AxesMeeting axes_meeting(const TubeEnd& a, const TubeEnd& b);

// At most one for each end.
std::vector<PipeJoint> pipe_joints(const std::vector<Tube>& tubes);

}  // namespace pcm::piping
