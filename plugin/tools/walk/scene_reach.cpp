#include "plugin/tools/walk/scene_reach.h"

#include "pcm/cloud/box_distance.h"
#include "pcm/cloud/numbers.h"
#include "pcm/cloud/vector.h"
#include "pcm/view/clearance.h"
#include "pcm/view/ground.h"
#include "plugin/scene/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace pcm::host {
namespace {

// Range of the distance, as fractions of the document's diagonal. Below it, walking would stop; above it, a step would
// pass the whole scene.
constexpr double least_share = 1.0 / 5000, most_share = 2;
constexpr double inside_share = 1.0 / 20;  // share of a mesh's diagonal, inside its box

// A layer's matrix in double.
struct Placement {
    double m[3][4];

    explicit Placement(const SceneLayer& layer)
    {
        const LayerMatrix matrix = layer.matrix();
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column)
                m[row][column] = static_cast<double>(matrix[std::size_t(row)][std::size_t(column)]);
    }
    double determinant() const
    {
        return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    }
    Vec3d apply(const Vec3d& p) const
    {
        Vec3d q;
        for (std::size_t row = 0; row < 3; ++row)
            q[row] = m[row][0] * p[0] + m[row][1] * p[1] + m[row][2] * p[2] + m[row][3];
        return q;
    }
    // The point that apply() maps to `q`, by Cramer's rule; none if the matrix is singular.
    std::optional<Vec3d> undo(const Vec3d& q) const
    {
        const double d = determinant();
        if (d == 0 || !std::isfinite(1 / d)) return std::nullopt;
        const Vec3d b{q[0] - m[0][3], q[1] - m[1][3], q[2] - m[2][3]};
        Vec3d p;
        for (std::size_t column = 0; column < 3; ++column) {
            Placement replaced = *this;
            for (std::size_t row = 0; row < 3; ++row) replaced.m[row][column] = b[row];
            p[column] = replaced.determinant() / d;
        }
        return p;
    }
    // Whether what is above a point stays above it.
    bool keeps_upright(std::size_t axis) const
    {
        const auto size = [](double a, double b) { return std::fabs(a) + std::fabs(b); };
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        return m[axis][axis] > 0 && size(m[axis][u], m[axis][v]) + size(m[u][axis], m[v][axis]) <= 1e-5 * m[axis][axis];
    }
    // Scale factor of lengths; exact if it is the same in all directions.
    double scale() const { return std::cbrt(std::fabs(determinant())); }
};

SceneReach reach_of_tree(const LayerCloud& tree, const Placement& placement, const Vec3d& place)
{
    const auto local = placement.undo(place);
    if (!local) return {infinity, 0};
    Vec3d source;
    for (std::size_t a = 0; a < 3; ++a) source[a] = (*local)[a] + tree.origin[a];
    const Clearance found = clearance(tree.cloud->cache(), source);
    return {found.distance * placement.scale(), found.error() * placement.scale()};
}

SceneReach reach_of_mesh(const SceneLayer& layer, const Placement& placement, const Vec3d& place)
{
    const Box3d box = layer.vertex_box();
    if (box.empty()) return {infinity, 0};
    Box3d shown;  // around the transformed corners
    for (unsigned corner = 0; corner < 8; ++corner)
        shown.extend(
            placement.apply({(corner & 1) != 0 ? box.max[0] : box.min[0], (corner & 2) != 0 ? box.max[1] : box.min[1],
                             (corner & 4) != 0 ? box.max[2] : box.min[2]}));
    const double square = squared_distance(shown, place);
    const double distance = std::max(std::sqrt(square), inside_share * shown.diagonal());
    return {distance, distance - std::sqrt(square)};
}

}  // namespace

SceneReach reach_from(SceneView& view, const Vec3d& place)
{
    const double diagonal = view.scene().diagonal();
    if (!(diagonal > 0) || !std::isfinite(diagonal)) return {};
    SceneReach nearest{infinity, 0};
    for (const SceneLayer* layer : view.scene().layers()) {
        if (!view.is_shown(*layer)) continue;
        const auto tree = layer->drawn();
        const Placement placement(*layer);
        const SceneReach reach =
            tree ? reach_of_tree(*tree, placement, place) : reach_of_mesh(*layer, placement, place);
        if (reach.distance < nearest.distance) nearest = reach;
    }
    const double bounded = std::clamp(nearest.distance, least_share * diagonal, most_share * diagonal);
    return {bounded, std::min(nearest.error, bounded)};
}

std::optional<SceneGround> ground_under(SceneView& view, const Vec3d& place, std::size_t axis)
{
    std::optional<SceneGround> lowest;
    for (const SceneLayer* layer : view.scene().layers()) {
        if (!view.is_shown(*layer)) continue;
        const auto tree = layer->drawn();
        const Placement placement(*layer);
        const auto local = tree && placement.keeps_upright(axis) ? placement.undo(place) : std::nullopt;
        if (!local) continue;
        const auto ground = pcm::ground_under(tree->cloud->cache(), *local + tree->origin, axis);
        if (!ground) continue;
        Vec3d there = *local;
        there[axis] = ground->height - tree->origin[axis];
        const double height = placement.apply(there)[axis];
        if (!lowest || height < lowest->height) lowest = SceneGround{height, ground->spacing * placement.scale()};
    }
    return lowest;
}

bool shows_clouds(SceneView& view)
{
    const auto layers = view.scene().layers();
    return std::any_of(layers.begin(), layers.end(), [](const SceneLayer* layer) { return layer->metadata(); });
}

}  // namespace pcm::host
