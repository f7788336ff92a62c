// Where places of a scene are in a picture, in double: computed relative to the eye, so that no two large numbers are
// subtracted at map coordinates, or before a near plane of 1e-6. No OpenGL here. Pure; any thread.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/matrix.h"
#include "pcm/cloud/vector.h"
#include "pcm/view/camera.h"

#include <array>
#include <optional>
#include <utility>

namespace pcm {

class ScreenMap {
public:
    // Absent when the camera can show nothing (Frustum::of()).
    static std::optional<ScreenMap> of(const Camera& camera);

    // Eye space of a place in source coordinates.
    Vec3d eye_of(const Vec3d& source) const;
    // Eye space of a direction in source units.
    Vec3d eye_direction(const Vec3d& direction) const
    {
        return {dot(linear_[0], direction), dot(linear_[1], direction), dot(linear_[2], direction)};
    }
    // Pixels from the picture's lower left corner, and the depth: -1 at the near plane, 1 at the far one. For a place
    // in eye space that is not before the near plane.
    Vec3d window_of(const Vec3d& eye) const;
    // The same of source coordinates; absent where that is before the near plane or behind the eye, or not finite.
    std::optional<Vec3d> place_of(const Vec3d& source) const;
    // The place in source coordinates whose window_of() this is; for orthographic views, and perspective ones.
    Vec3d source_of(const Vec3d& window) const;
    // The part of a segment, in eye space, that is beyond the near plane and at most `margin` pixels outside the
    // picture; absent if there is none, or an end is not finite.
    std::optional<std::pair<Vec3d, Vec3d>> clipped(const Vec3d& a, const Vec3d& b, double margin) const;

    bool orthographic() const { return orthographic_; }
    // The size of a pixel there, eye units.
    double pixel_at(const Vec3d& eye) const;
    // Eye units per source unit in the direction of the view's axes; exact where the modelview turns and scales.
    double scale() const { return scale_; }

private:
    using Vec4d = std::array<double, 4>;
    Vec4d clip_of(const Vec3d& eye) const;

    Camera camera_;
    std::array<Vec3d, 3> linear_{};  // rows of the modelview
    Vec3d eye_{};                    // relative to the camera's origin
    bool orthographic_ = false;
    double scale_ = 1;
};

}  // namespace pcm
