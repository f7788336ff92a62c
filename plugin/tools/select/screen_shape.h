// What a user draws on the screen as a part of space. Pure arithmetic in double; any number of threads.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/cloud/region.h"
#include "plugin/scene/view_map.h"
#include "plugin/tools/select/chosen_points.h"

#include <QPointF>

#include <optional>
#include <vector>

namespace pcm::host {

using ScreenShape = std::vector<QPointF>;  // corners of a polygon, Qt's pixels of the view

ScreenShape rectangle_of(const QPointF& a, const QPointF& b);
ScreenShape circle_of(const QPointF& centre, double radius);  // a polygon whose corners lie on it

// Whether it has a noticeable area: three corners, and not all of them within a pixel of a line along x or y.
bool has_area(const ScreenShape& shape);

// The view's camera for a cloud that `placement` (source coordinates to the scene's) moves: Camera::origin is in source
// coordinates of the cloud then.
Camera camera_for(const ViewMap& view, const std::optional<Affine>& placement);

// The shape in normalised device coordinates. Throws Error(invalid_argument) for a shape without area.
std::vector<Vec2d> polygon_of(const ScreenShape& shape, const ViewMap& view);

// The points of the cloud that appear in the shape, between the view's near and far plane. Even-odd rule for a shape
// that crosses itself. Throws what polygon_of() throws.
Region region_of(const ScreenShape& shape, const ViewMap& view, const std::optional<Affine>& placement);

// A ball of the scene in the coordinates of a cloud. A matrix that scales unequally makes an ellipsoid of it: the ball
// has its volume then. Nothing for a matrix that cannot be inverted.
std::optional<Ball> ball_in(const Ball& scene, const std::optional<Affine>& placement);

}  // namespace pcm::host
