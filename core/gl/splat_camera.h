// A view as the splats' shaders want it. No OpenGL here.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/view/level_of_detail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace pcm {

// Window coordinates are pixels as gl_FragCoord has them. Depth along the view is in eye units. Column-major matrices.
struct SplatCamera {
    // Nothing when Frustum::of() gives nothing. The viewport's lower left corner is at (x, y).
    static std::optional<SplatCamera> of(const Camera& view, int x, int y, bool reversed);

    Camera view;  // modelview and projection with a last element, or factor of w, of 1
    bool orthographic = false;
    Vec3d eye{};                         // relative to the view's origin
    double scale = 1;                    // eye units in a source unit: the most of any direction
    double squeeze = 1;                  // at most so many times as short is a source unit in another direction
    double near = 0;                     // depth of the near plane, of a perspective
    std::array<float, 16> projection{};  // to clip space, whose z is that of the depth convention
    std::array<double, 9> to_eye{};      // from source axes
    std::array<double, 9> normal_to_eye{};
    std::array<double, 2> focal{},
        principal{};                   // window = principal + focal * eye.xy / depth; parallel: without the quotient
    std::array<double, 2> depth_of{};  // window depth = [0] + [1] / depth; parallel: [0] + [1] * depth
    // Source axes: a pixel's step to the right and up, and the ray through the centre of `centre_pixel`, at a depth
    // of 1.
    Vec3d pixel_x{}, pixel_y{}, centre_ray{};
    std::array<double, 2> centre_pixel{};

    Vec3d eye_of(const Vec3d& local) const;  // eye space, of a place relative to the view's origin
    // Side, in pixels, of a square for a radius of 1 source unit at depth 1 (parallel: anywhere), for eq. 7.1, less
    // `scale`.
    double square_pixels() const { return 2 * focal[1]; }
    // At least the side, in pixels, of the largest dynamic splat, or of the box of the largest disc, of points in a box
    // (relative to the view's origin) that is not outside of the clip volume. Infinite when there is no bound.
    double largest_square(const Box3d& box, double radius) const;
    double largest_box(const Box3d& box, double radius) const;
    // The same of discs whose diameter is so many pixels where their centres are.
    double largest_box_of(double pixels) const;
    bool is_in_view(const Vec3d& local) const;  // as far as the sides of the view go
    // Pixels that a source unit covers at a depth in eye units, face on.
    double pixels_at(double depth) const
    {
        return scale * std::abs(focal[1]) / (orthographic ? 1 : std::max(depth, near));
    }

private:
    double least_depth(const Box3d& box) const;
    double bound_of(double k) const;
};

}  // namespace pcm
