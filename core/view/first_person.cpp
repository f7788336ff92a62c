#include "pcm/view/first_person.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace pcm {
namespace {

constexpr double level_enough = 1e-4;  // radians: less than a tenth of a pixel across a screen

// Directions of the scene: right and ahead at yaw 0, and up; right x ahead = up.
struct Horizon {
    Vec3d right, ahead, up;
};
Horizon horizon_of(UpAxis axis)
{
    if (axis == UpAxis::z) return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
}

[[noreturn]] void refuse_pose(const std::string& what)
{
    throw Error(ErrorCode::invalid_argument, {}, what,
                "Give a finite eye, right-handed unit axes and a focus above 0.");
}

// Right-handed unit axes by Gram-Schmidt, starting with the direction of view.
std::array<Vec3d, 3> orthonormal(const EyePose& pose)
{
    for (const Vec3d* v : {&pose.eye, &pose.right, &pose.up, &pose.back})
        if (!is_finite(*v)) refuse_pose("a pose has a number that is not finite");
    if (!(pose.focus > 0) || !std::isfinite(pose.focus)) refuse_pose("a pose has a focus that is not above 0");
    constexpr double tolerance = 1e-3;
    for (const Vec3d* v : {&pose.right, &pose.up, &pose.back})
        if (std::fabs(std::sqrt(dot(*v, *v)) - 1) > tolerance)
            refuse_pose("a pose has an axis that is not of unit length");
    const Vec3d back = (1 / std::sqrt(dot(pose.back, pose.back))) * pose.back;
    Vec3d up = pose.up - dot(pose.up, back) * back;
    const double up_length = std::sqrt(dot(up, up));
    if (std::fabs(up_length - 1) > tolerance) refuse_pose("a pose has axes that are not perpendicular");
    up = (1 / up_length) * up;
    const Vec3d right = cross(up, back);
    if (length(right - pose.right) > 2 * tolerance)
        refuse_pose("a pose has axes that are not perpendicular and right-handed");
    return {right, up, back};
}

}  // namespace

FirstPerson::FirstPerson(const EyePose& pose, UpAxis up_axis) : up_axis_(up_axis) { set_pose(pose); }

void FirstPerson::set_pose(const EyePose& pose)
{
    const auto axes = orthonormal(pose);
    eye_ = pose.eye;
    focus_ = pose.focus;
    orthographic_ = pose.orthographic;
    levelling_ = false;
    take_axes(axes);
}

void FirstPerson::set_up_axis(UpAxis axis)
{
    const auto seen = axes();
    up_axis_ = axis;
    take_axes(seen);
}

void FirstPerson::take_axes(const std::array<Vec3d, 3>& axes)
{
    const Horizon h = horizon_of(up_axis_);
    const auto& [right, up, back] = axes;
    // back = (cos p sin y, -cos p cos y, -sin p) in the horizon's axes, as ahead = -sin y right + cos y ahead at pitch
    // 0.
    const double sine = std::clamp(-dot(back, h.up), -1.0, 1.0);
    const double level = std::hypot(dot(back, h.right), dot(back, h.ahead));
    pitch_ = std::atan2(sine, level);
    // Straight up or down the yaw is arbitrary: the one without roll is chosen.
    constexpr double straight = 1e-6;
    yaw_ = level > straight ? std::atan2(dot(back, h.right), -dot(back, h.ahead))
                            : std::atan2(dot(right, h.ahead), dot(right, h.right));
    // Roll turns the level axes about the direction of view, counter-clockwise as the eye sees it.
    roll_ = 0;
    const auto flat = this->axes();
    roll_ = std::atan2(dot(right, flat[1]), dot(right, flat[0]));
    if (std::fabs(roll_) < 1e-9) roll_ = 0;
}

std::array<Vec3d, 3> FirstPerson::axes() const
{
    const Horizon h = horizon_of(up_axis_);
    const double sy = std::sin(yaw_), cy = std::cos(yaw_), sp = std::sin(pitch_), cp = std::cos(pitch_);
    const Vec3d right = cy * h.right + sy * h.ahead;
    const Vec3d ahead = -sy * h.right + cy * h.ahead;
    const Vec3d back = -cp * ahead + -sp * h.up;
    const Vec3d up = -sp * ahead + cp * h.up;
    const double sr = std::sin(roll_), cr = std::cos(roll_);
    return {cr * right + sr * up, -sr * right + cr * up, back};
}

EyePose FirstPerson::pose() const
{
    const auto [right, up, back] = axes();
    return {eye_, right, up, back, focus_, orthographic_};
}

void FirstPerson::turn(double yaw, double pitch)
{
    if (!std::isfinite(yaw) || !std::isfinite(pitch)) return;
    const Vec3d centre = pose().centre();
    yaw_ = std::remainder(yaw_ + yaw, 2 * pi);
    pitch_ = std::clamp(pitch_ + pitch, -pi / 2, pi / 2);
    if (orthographic_) eye_ = centre + focus_ * axes()[2];
    levelling_ = roll_ != 0;
}

void FirstPerson::change_speed(double notches)
{
    if (std::isfinite(notches))
        factor_ = std::clamp(factor_ * std::pow(wheel_factor, notches), least_factor, most_factor);
}

bool FirstPerson::moves(unsigned keys) const
{
    const auto held = [&](unsigned key) { return (keys & key) != 0; };
    return held(walk_forward) != held(walk_back) || held(walk_left) != held(walk_right) ||
           held(walk_up) != held(walk_down) || levelling_;
}

bool FirstPerson::step(double seconds, unsigned keys, double reach)
{
    if (!(seconds > 0) || !std::isfinite(seconds) || !moves(keys)) return false;
    const auto towards = [&](unsigned plus_key, unsigned minus_key) {
        return ((keys & plus_key) != 0) - ((keys & minus_key) != 0);
    };
    const int ahead = towards(walk_forward, walk_back), aside = towards(walk_right, walk_left),
              upwards = towards(walk_up, walk_down);
    const double speed = factor_ * ((keys & walk_fast) != 0 ? fast_factor : 1);

    if (ahead != 0 || aside != 0 || upwards != 0) {
        levelling_ = roll_ != 0;
        const auto now = axes();
        // Sideways is level and up is the scene's, so that walking with some roll left does not climb.
        const Vec3d level_right = std::cos(roll_) * now[0] - std::sin(roll_) * now[1];
        const Vec3d up = horizon_of(up_axis_).up;
        if (orthographic_) {
            // Moving across at speed v * focus while the focus shrinks as exp(-v t): the integral of v * exp(-v t) over
            // the step.
            const double rate = speed * ahead / std::sqrt(double(ahead * ahead + aside * aside + upwards * upwards));
            const double across = ahead != 0 ? std::fabs(1 - std::exp(-rate * seconds)) : 0;
            const double each = speed / std::sqrt(double(ahead * ahead + aside * aside + upwards * upwards)) * seconds;
            const double way = focus_ * (ahead != 0 ? across : each);
            // Projected to the plane of the picture: movement along the view has no visible effect.
            Vec3d move = (aside * way) * level_right + (upwards * way) * up;
            move = move - dot(move, now[2]) * now[2];
            const Vec3d centre = pose().centre() + move;
            focus_ = std::clamp(focus_ * std::exp(-rate * seconds), 1e-12, 1e12);
            eye_ = centre + focus_ * now[2];
        } else if (reach > 0 && std::isfinite(reach)) {
            const Vec3d move = double(-ahead) * now[2] + (double(aside) * level_right + double(upwards) * up);
            const double size = std::sqrt(dot(move, move));  // 0 for forwards and down while looking straight up
            if (size > 1e-9) eye_ = eye_ + (speed * reach * seconds / size) * move;
            focus_ = reach;
        }
    }
    if (levelling_) {
        roll_ *= std::exp(-seconds / levelling_seconds);
        if (std::fabs(roll_) < level_enough) {
            roll_ = 0;
            levelling_ = false;
        }
    }
    return true;
}

}  // namespace pcm
