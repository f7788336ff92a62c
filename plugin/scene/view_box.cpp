#include "plugin/scene/view_box.h"

#include "pcm/cloud/matrix.h"
#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "plugin/scene/origin.h"
#include "plugin/scene/scene.h"

#include <QStringList>

#include <algorithm>
#include <array>
#include <cmath>

namespace pcm::host {

namespace {

// Half the height of what an orthographic view shows, relative to the distance of its eye from its focus.
constexpr double orthographic_height = 1.75 / 8;

double height_over(const HalfSpace& space, const Vec3d& p) { return dot(space.normal, p) + space.offset; }

bool contains(const std::vector<HalfSpace>& spaces, const Vec3d& p)
{
    return std::all_of(spaces.begin(), spaces.end(), [&](const HalfSpace& s) { return height_over(s, p) >= 0; });
}

// Sutherland and Hodgman.
std::vector<Vec3d> cut(const std::vector<Vec3d>& polygon, const HalfSpace& space)
{
    std::vector<Vec3d> result;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double over_a = height_over(space, a), over_b = height_over(space, b);
        if (over_a >= 0) result.push_back(a);
        if ((over_a >= 0) != (over_b >= 0)) result.push_back(a + over_a / (over_a - over_b) * (b - a));
    }
    return result;
}

// In the coordinates of a layer's vertices: those of views are `matrix` * these.
std::vector<HalfSpace> before(const LayerMatrix& matrix, std::vector<HalfSpace> spaces)
{
    for (HalfSpace& space : spaces) {
        HalfSpace moved;
        moved.offset = space.offset;
        for (std::size_t row = 0; row < 3; ++row) {
            const double n = space.normal[row];
            moved.offset += n * static_cast<double>(matrix[row][3]);
            for (std::size_t column = 0; column < 3; ++column)
                moved.normal[column] += n * static_cast<double>(matrix[row][column]);
        }
        space = moved;
    }
    return spaces;
}

Vec3d before(const LayerMatrix& matrix, const Vec3d& place)
{
    Matrix4d by_column;
    for (std::size_t row = 0; row < 4; ++row)
        for (std::size_t column = 0; column < 4; ++column) by_column[column * 4 + row] = double(matrix[row][column]);
    const auto back = affine_inverse(by_column);
    Vec3d moved = place;
    for (std::size_t row = 0; back && row < 3; ++row)
        moved[row] =
            (*back)[row] * place[0] + (*back)[4 + row] * place[1] + (*back)[8 + row] * place[2] + (*back)[12 + row];
    return moved;
}

// The box of vertices in source coordinates. They are rounded to float: the box also has what they may stand for.
std::optional<Box3d> in_source(Box3d box, const Vec3d& origin)
{
    if (box.empty()) return std::nullopt;
    box = {box.min + origin, box.max + origin};
    const double rounding = float_rounding(box, origin);
    for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] -= rounding;
        box.max[a] += rounding;
    }
    return box;
}

Vec3d origin_of(const SceneLayer& layer) { return layer.scene().origin().value_or(Vec3d{0, 0, 0}); }

// Boxes of nodes are tight around the points of their subtrees: of a node that is seen in part, those below count.
Box3d seen_of_nodes(const Tree& tree, const std::vector<HalfSpace>& spaces, const Vec3d& origin, const Vec3d& eye)
{
    Box3d seen;
    std::vector<NodeId> open{0};
    while (!open.empty()) {
        const Node& node = tree.node(open.back());
        const Box3d around = tree.box(open.back()), box{around.min - origin, around.max - origin};
        open.pop_back();
        const Box3d inside = clipped(box, spaces, eye);
        if (inside.empty() || seen.contains(inside)) continue;
        if (node.is_leaf() || inside == box) {
            seen.extend(inside);
            continue;
        }
        for (const NodeId child : node.children)
            if (child != no_node) open.push_back(child);
    }
    return seen;
}

Box3d seen_of_tree(const Tree& tree, const std::vector<HalfSpace>& spaces, const Vec3d& origin, const Vec3d& eye)
{
    if (tree.nodes().empty()) return {};
    try {
        return seen_of_nodes(tree, spaces, origin, eye);
    } catch (const Error&) {  // nodes that cannot be read, which views report: the box of all
        return clipped({tree.box(0).min - origin, tree.box(0).max - origin}, spaces, eye);
    }
}

}  // namespace

std::vector<HalfSpace> seen_by(const EyePose& pose, float fov, double aspect)
{
    std::vector<HalfSpace> spaces;
    const auto add = [&](const Vec3d& normal, double at_eye) {
        spaces.push_back({normal, at_eye - dot(normal, pose.eye)});
    };
    for (const auto& [axis, share] : {std::pair(pose.right, aspect), std::pair(pose.up, 1.0)})
        for (const double sign : {1.0, -1.0}) {
            if (pose.orthographic)
                add(sign * axis, share * orthographic_height * pose.focus);
            else
                add(sign * axis - share * std::tan(static_cast<double>(fov) * pi / 360) * pose.back, 0);
        }
    if (!pose.orthographic) add(-1 * pose.back, 0);
    return spaces;
}

Box3d clipped(const Box3d& box, const std::vector<HalfSpace>& spaces, const Vec3d& apex)
{
    Box3d result;
    if (box.contains(apex) && contains(spaces, apex)) result.extend(apex);
    const auto corner = [&](bool x, bool y, bool z) {
        return Vec3d{x ? box.max[0] : box.min[0], y ? box.max[1] : box.min[1], z ? box.max[2] : box.min[2]};
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const bool high : {false, true}) {
            std::vector<Vec3d> face;
            for (const auto& [u, v] : {std::pair(false, false), {true, false}, {true, true}, {false, true}}) {
                std::array<bool, 3> side{};
                side[axis] = high;
                side[(axis + 1) % 3] = u;
                side[(axis + 2) % 3] = v;
                face.push_back(corner(side[0], side[1], side[2]));
            }
            for (const HalfSpace& space : spaces) face = cut(face, space);
            for (const Vec3d& p : face) result.extend(p);
        }
    // Interpolation rounds.
    for (std::size_t a = 0; a < 3 && !result.empty(); ++a) {
        result.min[a] = std::clamp(result.min[a], box.min[a], box.max[a]);
        result.max[a] = std::clamp(result.max[a], box.min[a], box.max[a]);
    }
    return result;
}

std::optional<Box3d> box_in_view(const SceneLayer& layer, const EyePose& pose, float fov, double aspect)
{
    const LayerMatrix matrix = layer.matrix();
    const std::vector<HalfSpace> spaces = before(matrix, seen_by(pose, fov, aspect));
    Box3d seen;
    layer.visit_vertices([&](const Vec3d& position, bool) {
        if (contains(spaces, position)) seen.extend(position);
    });
    if (const auto tree = layer.tree()) {
        seen.extend(seen_of_tree(*tree->cloud->tree(), spaces, tree->origin, before(matrix, pose.eye)));
    }
    return in_source(seen, origin_of(layer));
}

std::optional<Box3d> box_of_selection(const SceneLayer& layer)
{
    Box3d box;
    layer.visit_vertices([&](const Vec3d& position, bool is_selected) {
        if (is_selected) box.extend(position);
    });
    return in_source(box, origin_of(layer));
}

QString box_text(const Box3d& box)
{
    double extent = 0;
    for (std::size_t a = 0; a < 3; ++a) extent = std::max(extent, box.max[a] - box.min[a]);
    const int decimals = extent > 0 ? std::clamp(4 - static_cast<int>(std::floor(std::log10(extent))), 0, 12) : 9;
    const double per_unit = std::pow(10.0, decimals);
    QStringList numbers;
    // A number that is short already would otherwise move by a step, because the product is rounded.
    const auto add = [&](double v, double away) {
        const double nearest = std::round(v * per_unit) / per_unit;
        const bool outside = away < 0 ? nearest <= v : nearest >= v;
        numbers << QString::number(outside ? nearest : nearest + away / per_unit, 'f', decimals);
    };
    for (const double v : box.min) add(v, -1);
    for (const double v : box.max) add(v, 1);
    return numbers.join(' ');
}

}  // namespace pcm::host
