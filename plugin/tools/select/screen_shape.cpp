#include "plugin/tools/select/screen_shape.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>

namespace pcm::host {

ScreenShape rectangle_of(const QPointF& a, const QPointF& b) { return {a, {b.x(), a.y()}, b, {a.x(), b.y()}}; }

ScreenShape circle_of(const QPointF& centre, double radius)
{
    constexpr double most_off = 0.25;  // maximum distance of the polygon from the circle, pixels
    const int corners =
        std::clamp(static_cast<int>(std::ceil(pi / std::acos(1 - most_off / std::max(radius, 1.0)))), 12, 360);
    ScreenShape circle;
    for (int i = 0; i < corners; ++i)
        circle.push_back(centre + radius * QPointF(std::cos(2 * pi * i / corners), std::sin(2 * pi * i / corners)));
    return circle;
}

bool has_area(const ScreenShape& shape)
{
    if (shape.size() < 3) return false;
    const auto [left, right] = std::minmax_element(shape.begin(), shape.end(),
                                                   [](const QPointF& a, const QPointF& b) { return a.x() < b.x(); });
    const auto [top, bottom] = std::minmax_element(shape.begin(), shape.end(),
                                                   [](const QPointF& a, const QPointF& b) { return a.y() < b.y(); });
    return right->x() - left->x() >= 1 && bottom->y() - top->y() >= 1;
}

Camera camera_for(const ViewMap& view, const std::optional<Affine>& placement)
{
    Camera camera = view.camera();
    if (!placement) return camera;
    const Vec3d shift = placement->target - camera.origin;
    Matrix4d move = identity_matrix;
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 3; ++column) move[column * 4 + row] = placement->linear[row][column];
        move[12 + row] = shift[row];
    }
    camera.modelview = product(camera.modelview, move);
    camera.origin = placement->pivot;
    return camera;
}

std::vector<Vec2d> polygon_of(const ScreenShape& shape, const ViewMap& view)
{
    if (!has_area(shape))
        throw Error(ErrorCode::invalid_argument, {}, "the shape on the screen has no area",
                    "drag farther, or click three corners at least");
    std::vector<Vec2d> corners;
    for (const QPointF& pixel : shape) corners.push_back(view.device(pixel));
    return corners;
}

Region region_of(const ScreenShape& shape, const ViewMap& view, const std::optional<Affine>& placement)
{
    const Camera camera = camera_for(view, placement);
    return Region::lasso(camera.modelview, camera.projection, camera.origin, polygon_of(shape, view));
}

std::optional<Ball> ball_in(const Ball& scene, const std::optional<Affine>& placement)
{
    if (!placement) return scene;
    const double determinant = placement->determinant();
    if (determinant == 0 || !std::isfinite(1 / determinant)) return std::nullopt;
    const auto& m = placement->linear;
    const Vec3d d = scene.centre - placement->target;
    // Rows of the inverse matrix are cross products of the matrix's columns.
    const auto column = [&](std::size_t c) { return Vec3d{m[0][c], m[1][c], m[2][c]}; };
    Ball ball;
    for (std::size_t a = 0; a < 3; ++a)
        ball.centre[a] = dot(cross(column((a + 1) % 3), column((a + 2) % 3)), d) / determinant + placement->pivot[a];
    ball.radius = scene.radius / std::cbrt(std::fabs(determinant));
    return ball;
}

}  // namespace pcm::host
