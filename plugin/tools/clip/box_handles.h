// The places of a clip box that a user drags, and what dragging does. Pure arithmetic in double, in coordinates of the
// scene; any number of threads.
#pragma once

#include "plugin/scene/scene_state.h"
#include "plugin/scene/view_map.h"

#include <optional>

namespace pcm::host {

struct BoxHandle {
    enum class Kind {
        face,    // moves one face along its axis
        centre,  // moves the box in the plane of the view, or along its thinnest axis
        turn,    // turns the box about its third axis; in the middle of the edge between the faces +0 and +1
    } kind = Kind::centre;
    std::size_t axis = 0;  // axis of a face
    double side = 1;       // side of a face: 1 or -1

    bool operator==(const BoxHandle& o) const { return kind == o.kind && axis == o.axis && side == o.side; }
};

std::array<BoxHandle, 8> all_handles();
Vec3d place_of(const ClipBox& box, const BoxHandle& handle);
// The corners: bit k of the number is set on the positive side of axis k.
std::array<Vec3d, 8> corners_of(const ClipBox& box);

// The handle within `reach` pixels of `pixel` that is nearest to it on the screen; of several at the same place the
// nearest to the eye.
std::optional<BoxHandle> handle_at(const ClipBox& box, const ViewMap& view, const QPointF& pixel, double reach);

// The box after dragging a handle from one pixel to another; `box` is the one at the beginning. A size stays above
// least_half(). With `along_axis` the centre moves along the thinnest axis only.
ClipBox dragged(const ClipBox& box, const BoxHandle& handle, const ViewMap& view, const QPointF& from,
                const QPointF& to, bool along_axis = false);

// The smallest half size of a box at this place that double resolves.
double least_half(const ClipBox& box);
std::size_t thinnest_axis(const ClipBox& box);
// Turned about its third axis, counter-clockwise as seen from its tip. Axes stay perpendicular to rounding.
ClipBox turned(const ClipBox& box, double degrees);
// The angle from the scene's x axis to the box's first one, in (-180, 180] degrees; nothing where the third axis is not
// the scene's z axis.
std::optional<double> turn_of(const ClipBox& box);

ClipBox box_around(const Box3d& bounds);  // upright; a flat side gets a size above 0
// The box with two places at opposite ends of its diagonal, upright, as high as `height` at least.
ClipBox box_between(const Vec3d& a, const Vec3d& b, const Box3d& height);
// A vertical section along the line from `a` to `b`: it ends at them, is `thickness` wide and as high as `height`. Its
// second axis is across the line. Throws Error(invalid_argument) where one point is above the other.
ClipBox section_between(const Vec3d& a, const Vec3d& b, double thickness, const Box3d& height);
// A slab: `thickness` along one of the box's axes, and beyond `bounds` along the others.
ClipBox slab_of(const ClipBox& box, std::size_t axis, double thickness, const Box3d& bounds);
// Moved by steps of its size along an axis.
ClipBox stepped(const ClipBox& box, std::size_t axis, double steps);

}  // namespace pcm::host
