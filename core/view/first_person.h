// An eye that walks through a scene: position, direction, speed. Pure arithmetic in double; no clock, no window.
//
// The horizon is kept level: turning is yaw about the scene's up axis and pitch above or below the horizontal plane. An
// eye taken over from a camera with roll keeps the roll until the first movement and then loses it smoothly, so that
// nothing jumps.
//
// In a perspective view, moving moves the eye. In an orthographic view the distance of the eye has no visible effect:
// there forward and back zoom about the centre of the picture, and turning rotates about that centre.
//
// One thread at a time.
#pragma once

#include "pcm/cloud/vector.h"

#include <array>
#include <cstdint>

namespace pcm {

enum class UpAxis : std::uint8_t { y, z };

// Position and axes of the eye in the scene. The axes are perpendicular unit vectors, right-handed: right x up = back.
struct EyePose {
    Vec3d eye{};
    Vec3d right{1, 0, 0}, up{0, 1, 0}, back{0, 0, 1};  // back points from the scene to the eye
    // Distance from the eye to the point in the centre of the picture about which the host's orbiting camera turns;
    // above 0. In an orthographic view the visible height is proportional to it.
    double focus = 1;
    bool orthographic = false;
    Vec3d centre() const { return eye - focus * back; }
};

// The keys held down: an OR of these.
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
    static constexpr double levelling_seconds = 0.15;  // in which roll decays to 1/e

    // Axes are orthonormalised. Throws Error(invalid_argument) for numbers that are not finite, axes off by more than
    // about 1e-3 or left-handed, and a focus that is not above 0.
    FirstPerson(const EyePose& pose, UpAxis up_axis);

    // Keeps the eye and the picture, changes the horizon.
    void set_up_axis(UpAxis axis);
    UpAxis up_axis() const { return up_axis_; }
    // Takes over a camera that was moved by other means; the speed stays. Throws like the constructor.
    void set_pose(const EyePose& pose);
    EyePose pose() const;

    // Radians; yaw to the left, pitch upwards, clamped at straight up and down.
    void turn(double yaw, double pitch);
    // Changes the speed by `notches` of a mouse wheel.
    void change_speed(double notches);
    double factor() const { return factor_; }

    // Moves for `seconds` with `keys` held down. `reach` (source units, above 0) is the distance to the nearest points:
    // the eye moves factor() * reach per second, fast_factor times that with walk_fast, however many directions are
    // held at once; opposite ones cancel. An orthographic view uses its focus instead, and zooms by a constant ratio
    // per second. Many short steps end where one long step ends, as long as `reach` is the same. Afterwards the focus
    // is at `reach`, unless the view is orthographic. Returns whether anything changed.
    bool step(double seconds, unsigned keys, double reach);
    // Whether step() would change anything: a direction is held, or the horizon is being levelled.
    bool moves(unsigned keys) const;

    double yaw() const { return yaw_; }      // radians; 0 looks along y with z up, and along -z with y up
    double pitch() const { return pitch_; }  // -pi/2..pi/2
    double roll() const { return roll_; }

private:
    std::array<Vec3d, 3> axes() const;  // right, up, back
    // Sets yaw, pitch and roll from axes, relative to this horizon.
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
