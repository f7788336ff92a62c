// Random trees and views of them, and projection by plain matrix products.
#pragma once

#include "pcm/view/level_of_detail.h"

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace pcm::test {

inline Matrix4d identity() { return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }

inline Matrix4d translation(const Vec3d& t)
{
    Matrix4d m = identity();
    for (std::size_t a = 0; a < 3; ++a) m[12 + a] = t[a];
    return m;
}

inline Matrix4d scaling(double s)
{
    Matrix4d m = identity();
    m[0] = m[5] = m[10] = s;
    return m;
}

inline Matrix4d rotation(std::mt19937_64& random)
{
    std::normal_distribution<double> normal;
    double q[4];
    double length = 0;
    for (double& v : q) v = normal(random), length += v * v;
    for (double& v : q) v /= std::sqrt(length);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    return {1 - 2 * (y * y + z * z),
            2 * (x * y + w * z),
            2 * (x * z - w * y),
            0,
            2 * (x * y - w * z),
            1 - 2 * (x * x + z * z),
            2 * (y * z + w * x),
            0,
            2 * (x * z + w * y),
            2 * (y * z - w * x),
            1 - 2 * (x * x + y * y),
            0,
            0,
            0,
            0,
            1};
}

inline Matrix4d perspective(double left, double right, double bottom, double top, double near, double far)
{
    return {2 * near / (right - left),
            0,
            0,
            0,
            0,
            2 * near / (top - bottom),
            0,
            0,
            (right + left) / (right - left),
            (top + bottom) / (top - bottom),
            -(far + near) / (far - near),
            -1,
            0,
            0,
            -2 * far * near / (far - near),
            0};
}

inline Matrix4d orthographic(double half_width, double half_height, double near, double far)
{
    return {1 / half_width,
            0,
            0,
            0,
            0,
            1 / half_height,
            0,
            0,
            0,
            0,
            -2 / (far - near),
            0,
            0,
            0,
            -(far + near) / (far - near),
            1};
}

inline std::array<double, 4> clip(const Camera& view, const Vec3d& source)
{
    const auto apply = [](const Matrix4d& m, const std::array<double, 4>& v) {
        std::array<double, 4> r{};
        for (std::size_t row = 0; row < 4; ++row)
            for (std::size_t column = 0; column < 4; ++column) r[row] += m[column * 4 + row] * v[column];
        return r;
    };
    const std::array<double, 4> local{source[0] - view.origin[0], source[1] - view.origin[1],
                                      source[2] - view.origin[2], 1};
    return apply(view.projection, apply(view.modelview, local));
}

inline bool is_visible(const std::array<double, 4>& c)
{
    for (std::size_t a = 0; a < 3; ++a)
        if (!(std::abs(c[a]) <= c[3])) return false;
    return true;
}

// Looks from `eye` in a random direction; the modelview scales like a trackball's.
inline Camera random_view(std::mt19937_64& random, const Vec3d& eye, const Vec3d& origin, double reach)
{
    std::uniform_real_distribution<double> unit(0, 1);
    Camera view;
    view.origin = origin;
    view.width = 1280;
    view.height = 720;
    const double scale = std::pow(10.0, 4 * unit(random) - 2);
    view.modelview =
        product(rotation(random),
                product(scaling(scale), translation({origin[0] - eye[0], origin[1] - eye[1], origin[2] - eye[2]})));
    const double near = scale * reach * std::pow(10.0, -6 * unit(random));
    const double far = near * std::pow(10.0, 1 + 11 * unit(random));
    if (unit(random) < 0.5) {
        const double half = near * (0.1 + unit(random));
        const double shift = half * (unit(random) - 0.5);  // off-axis
        view.projection = perspective(shift - half * 16 / 9, shift + half * 16 / 9, -half, half, near, far);
    } else {
        const double half = scale * reach * (0.05 + unit(random));
        view.projection = orthographic(half * 16 / 9, half, near * (unit(random) < 0.5 ? 1 : -1), far);
    }
    return view;
}

struct SyntheticTree {
    NodeTable nodes;
    Grid grid;
};

// Random splits along random axes; some nodes without points, some with one child, some boxes flat, thin or a point.
inline SyntheticTree random_tree(std::mt19937_64& random, std::size_t size, const Vec3d& offset)
{
    std::uniform_real_distribution<double> unit(0, 1);
    SyntheticTree tree;
    std::vector<Node> nodes;
    tree.grid.scale = {0.001, 0.001, 0.001};
    tree.grid.offset = offset;
    Node root;
    root.box.min = {0, 0, 0};
    root.box.max = {200000, 150000, 40000};
    if (unit(random) < 0.2) root.box.max[random() % 3] = 0;  // flat
    root.spacing = 5;
    root.subtree_points = 1;
    nodes.push_back(root);
    for (std::size_t parent = 0; parent < nodes.size() && nodes.size() < size; ++parent) {
        const std::size_t axis = random() % 3;
        const Box3i box = nodes[parent].box;
        const std::int64_t split =
            box.min[axis] +
            static_cast<std::int64_t>(unit(random) * static_cast<double>(box.max[axis] - box.min[axis]));
        for (std::size_t c = 0; c < 2; ++c) {
            if (parent > 0 && unit(random) < 0.1) continue;
            Node child;
            child.parent = static_cast<NodeId>(parent);
            child.depth = static_cast<std::uint16_t>(nodes[parent].depth + 1);
            child.box = box;
            (c == 0 ? child.box.max : child.box.min)[axis] = split;
            if (unit(random) < 0.03) child.box.max = child.box.min;  // coincident points
            child.spacing = nodes[parent].spacing * (0.6 + 0.4 * unit(random));
            child.points = unit(random) < 0.05 ? 0 : 1 + static_cast<std::uint32_t>(random() % 5000);
            child.subtree_points = 1;
            nodes[parent].children[c] = static_cast<NodeId>(nodes.size());
            nodes.push_back(child);
        }
    }
    for (Node& node : nodes)
        if (node.is_leaf()) node.spacing = 0;
    nodes[0].points = unit(random) < 0.1 ? 0 : 3000;
    tree.nodes = NodeTable(std::move(nodes));
    return tree;
}

}  // namespace pcm::test
