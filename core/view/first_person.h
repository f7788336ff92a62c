// An eye that walks through a scene: position, direction, speed. Pure arithmetic in double; no clock, no window.
//
// The horizon is kept level: turning is yaw about the scene's up axis and pitch above or below the horizontal plane. An
// eye that was taken over from a camera with some roll keeps it until it is used, and loses it smoothly then, so that
// nothing jumps.
//
// In a perspective view, moving moves the eye. In an orthographic view the distance of the eye from what it sees shows
// nothing: there forward and back make the view smaller and larger about the centre of the picture, and turning turns
// about that centre.
//
// Not for several threads at once.
#pragma once

#include "pcm/cloud/vector.h"

#include <array>
#include <cstdint>

namespace pcm {

enum class UpAxis : std::uint8_t { y, z };

// The eye's place and axes in the scene. Axes are unit vectors, perpendicular, right-handed: right x up = back.
struct EyePose {
    Vec3d eye{};
    Vec3d right{1, 0, 0}, up{0, 1, 0}, back{0, 0, 1};  // back points from what is seen to the eye
    // Distance from the eye to the point in the centre of the picture about which a host's orbiting camera turns; above
    // 0. In an orthographic view what is seen is as high as a constant times this.
    double focus = 1;
    bool orthographic = false;
    Vec3d centre() const { return eye - focus * back; }
};

// What is held down: an OR of these.
enum WalkKey : unsigned {
    walk_forward = 1,
    walk_back = 2,
    walk_left = 4,
    walk_right = 8,
    walk_up = 16,
    walk_down = 32,
    walk_fast = 64,
};

class FirstPerson {
public:
    // One second at factor 1 moves the eye by `reach`, see step().
    static constexpr double least_factor = 1.0 / 64, most_factor = 64, fast_factor = 4, wheel_factor = 1.25;
    static constexpr double levelling_seconds = 0.15;  // in which roll falls to 1/e

    // Axes that are not quite unit and perpendicular are made so. Throws Error(invalid_argument) for numbers that are
    // not finite, axes that are far from it or left-handed, and a focus that is not above 0.
    FirstPerson(const EyePose& pose, UpAxis up_axis);

    // The same eye and picture, another horizon.
    void set_up_axis(UpAxis axis);
    UpAxis up_axis() const { return up_axis_; }
    // Takes over a camera that somebody else has moved; the speed stays. Throws as the constructor.
    void set_pose(const EyePose& pose);
    EyePose pose() const;

    // Radians; yaw to the left, pitch upwards, which ends when one looks straight up or down.
    void turn(double yaw, double pitch);
    // Changes the speed by so many notches of a wheel.
    void change_speed(double notches);
    double factor() const { return factor_; }

    // Moves for `seconds` with `keys` held down. `reach` (source units, above 0) is how far it is to the nearest
    // points: the eye moves factor() * reach a second, fast_factor times that with walk_fast, however many directions
    // are held at once; opposite ones cancel. Many short steps end where one long step ends, as long as `reach` is the
    // same (an orthographic view takes its focus for it and comes nearer by a constant ratio a second). Afterwards the
    // focus is at `reach`, unless the view is orthographic. Returns whether anything changed.
    bool step(double seconds, unsigned keys, double reach);
    // Whether step() would change something: there is a direction, or the horizon is being levelled.
    bool moves(unsigned keys) const;

    double yaw() const { return yaw_; }      // radians; 0 looks along y with z up, and along -z with y up
    double pitch() const { return pitch_; }  // -pi/2..pi/2
    double roll() const { return roll_; }

private:
    std::array<Vec3d, 3> axes() const;  // right, up, back
    // Yaw, pitch and roll of the pose's axes above this horizon.
    void take_axes(const std::array<Vec3d, 3>& axes);

    UpAxis up_axis_;
    Vec3d eye_{};
    double yaw_ = 0, pitch_ = 0, roll_ = 0;
    double focus_ = 1;
    bool orthographic_ = false;
    double factor_ = 1;
    bool levelling_ = false;
};

}  // namespace pcm
