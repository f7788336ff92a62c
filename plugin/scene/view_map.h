// Conversion between pixels of a view and places of its scene (scene/annotations.h), in double.
//
// Pixels are Qt's: x to the right, y downwards, from the upper left corner of the view.
#pragma once

#include "pcm/view/camera.h"

#include <QPointF>

#include <optional>

namespace pcm::host {

struct SceneRay {
    Vec3d from{};       // on the ray, in front of the near plane or in it
    Vec3d direction{};  // unit vector, away from the eye
};

// Immutable; any number of threads.
class ViewMap {
public:
    // `camera` maps places of the scene minus Camera::origin; `ratio` of its pixels are one of Qt's. Throws
    // Error(invalid_argument) for a camera that cannot be inverted or shows nothing.
    ViewMap(const Camera& camera, double ratio);

    const Camera& camera() const { return camera_; }
    // The pixel at which a place appears, which may be outside of the view; nothing for a place behind the eye.
    std::optional<QPointF> pixel_of(const Vec3d& place) const;
    // What the pixel shows.
    SceneRay ray(const QPointF& pixel) const;
    // A place that appears at the pixel, between the near and the far plane.
    Vec3d place_at(const QPointF& pixel) const;
    // The pixel in normalised device coordinates: -1 to 1, y upwards.
    std::array<double, 2> device(const QPointF& pixel) const;
    // The length that one pixel covers at a place.
    double pixel_size(const Vec3d& place) const;
    // The unit vector from the scene to the eye.
    const Vec3d& back() const { return back_; }
    bool is_parallel() const { return camera_.projection[11] == 0; }

private:
    Vec3d eye_space(const Vec3d& place) const;

    Camera camera_;
    Matrix4d inverse_{};  // inverse of the modelview matrix
    double ratio_;
    Vec3d back_{};
};

}  // namespace pcm::host
