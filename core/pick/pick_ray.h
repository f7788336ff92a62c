// The ray that a pixel of a picture sees.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/cloud/vector.h"
#include "pcm/view/camera.h"

#include <limits>
#include <optional>

namespace pcm {

// Lengths are in source units. Positions p are taken as (p - centre) - start, so that with a centre near the eye map
// coordinates cost no digits, and near planes of 1e-6 hold.
struct PickRay {
    Vec3d centre{};
    Vec3d start{};            // relative to the centre
    Vec3d direction{};        // unit vector; t is the distance from the start along it
    double pixel = 0;         // the size of a pixel at the start,
    double pixel_growth = 0;  // and by how much it grows with t
    double begin = 0, end = std::numeric_limits<double>::infinity();  // range of t: where the picture begins and ends
    double scale = 1;  // lengths on this ray for one on the ray that it was made from

    double pixel_at(double t) const { return pixel + t * pixel_growth; }

    // Through the point (x, y) of the picture: pixels from its upper left corner, to the right and down, so that the
    // first pixel's centre is at (0.5, 0.5). Perspective, off-axis too: starts at the eye; orthographic: on the near
    // plane. Begins at the near plane and ends at the far plane. Absent for a camera that can show nothing
    // (view/frustum.h), and for a place that is not finite.
    static std::optional<PickRay> through(const Camera& camera, double x, double y);

    // From a place in a direction of any length but 0. A pixel is `pixel` large at the start and grows by
    // `pixel_growth`. Throws Error(invalid_argument) for numbers that are not finite, no direction, or sizes below 0.
    static PickRay along(const Vec3d& from, const Vec3d& direction, double pixel, double pixel_growth);

    // The ray as a cloud sees it that `placement` has moved to where the ray is. Lengths are those of the cloud,
    // `scale` times as large. Absent when the placement is singular.
    std::optional<PickRay> before(const Affine& placement) const;
};

}  // namespace pcm
