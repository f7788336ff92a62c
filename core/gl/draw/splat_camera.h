// A view in the form that the splats' shaders need. No OpenGL here.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/view/level_of_detail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace pcm {

// Window coordinates are pixels, like gl_FragCoord. Depth along the view is in eye units. Column-major matrices.
struct SplatCamera {
    // Empty when Frustum::of() is. The viewport's lower left corner is at (x, y).
    static std::optional<SplatCamera> of(const Camera& view, int x, int y, bool reversed);

    Camera view;  // modelview and projection scaled to a last element, or factor of w, of 1
    bool orthographic = false;
    Vec3d eye{};                         // relative to the view's origin
    double scale = 1;                    // eye units per source unit: the largest of any direction
    double squeeze = 1;                  // bound of the ratio of the largest to the smallest scale of any direction
    double near = 0;                     // depth of the near plane; perspective only
    std::array<float, 16> projection{};  // to clip space, z in the depth convention
    std::array<double, 9> to_eye{};      // from source axes
    std::array<double, 9> normal_to_eye{};
    std::array<double, 2> focal{},
        principal{};  // window = principal + focal * eye.xy / depth; orthographic: without the division
    std::array<double, 2> depth_of{};  // window depth = [0] + [1] / depth; orthographic: [0] + [1] * depth
    // In source axes, at a depth of 1: one pixel to the right, one pixel up, and the ray through the centre of
    // `centre_pixel`.
    Vec3d pixel_x{}, pixel_y{}, centre_ray{};
    std::array<double, 2> centre_pixel{};

    Vec3d eye_of(const Vec3d& local) const;  // eye space, of a place relative to the view's origin
    // Side, in pixels, of a square for a radius of 1 eye unit at depth 1 (orthographic: anywhere), for eq. 7.1.
    double square_pixels() const { return 2 * focal[1]; }
    // Upper bound of the side, in pixels, of the largest adaptive splat, or of the box of the largest disc, for points
    // in a box (relative to the view's origin) that intersects the clip volume. Infinite when there is none.
    double largest_square(const Box3d& box, double radius) const;
    double largest_box(const Box3d& box, double radius) const;
    // The same for discs whose diameter, at their centres, is this many pixels.
    double largest_box_of(double pixels) const;
    bool is_in_view(const Vec3d& local) const;  // tests the sides of the view, not near and far
    // Pixels per source unit at a depth in eye units, face-on.
    double pixels_at(double depth) const
    {
        return scale * std::abs(focal[1]) / (orthographic ? 1 : std::max(depth, near));
    }

private:
    double least_depth(const Box3d& box) const;
    double bound_of(double k) const;
};

}  // namespace pcm
