// Which boxes a camera sees, and how large. No OpenGL here. All functions are pure: the same arguments give the same
// result on any thread.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/cloud/matrix.h"
#include "pcm/cloud/vector.h"
#include "pcm/view/camera.h"

#include <array>
#include <optional>

namespace pcm {

// A camera prepared for classifying boxes. All computation is relative to the eye: no two large numbers are subtracted,
// so results hold at map coordinates and for near planes of 1e-6.
class Frustum {
public:
    // Absent when the camera can show nothing: an empty viewport, numbers that are not finite, or a modelview that is
    // not affine and invertible.
    static std::optional<Frustum> of(const Camera& view);

    // False only if no part of the box is inside the clip volume. May be true for a box just outside a corner or an
    // edge of the volume (the six planes are tested one by one), never false for a box with a visible point: the margin
    // covers the rounding of coordinates of this size.
    bool intersects(const Box3d& source_box) const;

    // Pixels that a length of `size` (source units) across the view covers at the point of the box nearest to the eye,
    // but no nearer than the near plane. Exact on the view's axis; an upper bound for a modelview that scales the axes
    // differently.
    double pixels(double size, const Box3d& source_box) const;

    // True only if the whole box is inside the clip volume; may be false for a box inside that touches its boundary.
    bool contains(const Box3d& source_box) const;

    Vec3d local_eye() const { return eye_; }  // relative to the view's origin
    Vec3d eye() const;                        // source coordinates
    bool orthographic() const { return orthographic_; }

private:
    struct Plane {
        Vec3d normal;        // in source axes, pointing inwards
        double offset;       // normal . (p - eye) + offset >= 0 inside
        Vec3d normal_bound;  // the same sums over absolute values: they bound the rounding error
        double offset_bound;
    };
    // The plane's value at the corner of the box farthest along the normal (sign 1) or against it (-1).
    struct Side {
        double value, rounding;
    };
    Side side_of(const Plane& plane, const Box3d& box, double sign) const;

    using Matrix3d = std::array<Vec3d, 3>;  // rows
    void set_planes(const Matrix3d& linear, const Matrix4d& projection);
    bool set_scale(const Matrix3d& linear, const Camera& view);  // false when sizes are not finite

    std::array<Plane, 6> planes_{};
    Vec3d origin_{};
    Vec3d eye_{};  // relative to origin_
    bool orthographic_ = false;
    double near_ = 0;             // perspective: distance of the near plane, source units
    double pixels_per_unit_ = 0;  // orthographic: anywhere; perspective: at distance 1
};

}  // namespace pcm
