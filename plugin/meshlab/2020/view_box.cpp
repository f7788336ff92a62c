#include "plugin/meshlab/2020/view_box.h"

#include "pcm/cloud/vector.h"
#include "plugin/scene/origin.h"

#include <QStringList>

#include <algorithm>
#include <array>
#include <cmath>

namespace pcm::host {

namespace {

constexpr double view_ratio = 1.75;  // trackball_pose.h

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

// In the coordinates of a layer's vertices: MeshLab's are `matrix` * those.
std::vector<HalfSpace> before(const Matrix44m& matrix, std::vector<HalfSpace> spaces)
{
    for (HalfSpace& space : spaces) {
        HalfSpace moved;
        moved.offset = space.offset;
        for (int row = 0; row < 3; ++row) {
            const double n = space.normal[static_cast<std::size_t>(row)];
            moved.offset += n * static_cast<double>(matrix[row][3]);
            for (int column = 0; column < 3; ++column)
                moved.normal[static_cast<std::size_t>(column)] += n * static_cast<double>(matrix[row][column]);
        }
        space = moved;
    }
    return spaces;
}

Vec3d position_of(const CVertexO& vertex)
{
    const Point3m& p = vertex.cP();
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
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

Vec3d origin_of(const MeshModel& layer)
{
    return Registry::instance().origin_of(*layer.parent).value_or(Vec3d{0, 0, 0});
}

// The chunks at the leaves have tight boxes, and coarser points lie among theirs.
Box3d seen_of_tree(const Tree& tree, const std::vector<HalfSpace>& spaces, const Vec3d& origin, const Vec3d& eye)
{
    Box3d seen;
    for (NodeId id = 0; id < tree.nodes().size(); ++id) {
        if (!tree.nodes()[id].is_leaf() || tree.nodes()[id].subtree_points == 0) continue;
        const Box3d box = tree.box(id);
        seen.extend(clipped({box.min - origin, box.max - origin}, spaces, eye));
    }
    return seen;
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
                add(sign * axis, share * view_ratio / 8 * pose.focus);  // 8: the camera's distance, trackball_pose.h
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

std::optional<Box3d> box_in_view(const MeshModel& layer, const EyePose& pose, float fov, double aspect)
{
    const std::vector<HalfSpace> spaces = before(layer.cm.Tr, seen_by(pose, fov, aspect));
    Box3d seen;
    for (const CVertexO& vertex : layer.cm.vert)
        if (!vertex.IsD() && contains(spaces, position_of(vertex))) seen.extend(position_of(vertex));
    if (const auto tree = Registry::instance().find(layer)) {
        const Matrix44m back = vcg::Inverse(layer.cm.Tr);
        const Point3m eye = back * Point3m(static_cast<float>(pose.eye[0]), static_cast<float>(pose.eye[1]),
                                           static_cast<float>(pose.eye[2]));
        seen.extend(
            seen_of_tree(*tree->cloud->tree(), spaces, tree->origin,
                         {static_cast<double>(eye[0]), static_cast<double>(eye[1]), static_cast<double>(eye[2])}));
    }
    return in_source(seen, origin_of(layer));
}

std::optional<Box3d> box_of_selection(const MeshModel& layer)
{
    Box3d box;
    for (const CVertexO& vertex : layer.cm.vert)
        if (!vertex.IsD() && vertex.IsS()) box.extend(position_of(vertex));
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
