// Clouds of points on known surfaces.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/place/local_fit.h"
#include "pcm/query/point_set.h"
#include "pcm/shapes/shape.h"
#include "pcm/tree/source_rounding.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace pcm::test {

// Random numbers that are the same with every library.
class Dice {
public:
    explicit Dice(std::uint64_t seed) : random_(seed) {}
    double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    double normal() { return std::sqrt(-2 * std::log(1 - unit())) * std::cos(2 * pi * unit()); }
    Vec3d direction()
    {
        const double z = between(-1, 1), a = between(0, 2 * pi), r = std::sqrt(1 - z * z);
        return {r * std::cos(a), r * std::sin(a), z};
    }

private:
    std::mt19937_64 random_;
};

// A click for any kind, with a neighbourhood and a threshold that are chosen.
inline LocalFitOptions any_kind()
{
    LocalFitOptions options;
    for (const ShapeTraits& row : shape_kinds()) options.kinds.push_back(row.kind);
    return options;
}

struct SurfacePoint {
    Vec3d position{}, normal{};
};

// Two unit vectors across an axis.
inline std::array<Vec3d, 2> across(const Vec3d& axis)
{
    const Vec3d u = normalised(cross(axis, std::fabs(axis[0]) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
    return {u, cross(axis, u)};
}

// A point of the surface: of a plane within `size` of its point in each of two directions, of a cylinder and a cone
// `size` along the axis, of a part of the circle from 0 to `arc`; its distance from the surface is normal with
// `sigma`.
inline SurfacePoint point_on(const pcm::Shape& shape, double size, double arc, double sigma, Dice& dice)
{
    const auto [u, v] = across(shape.axis);
    const double a = dice.between(0, arc);
    const Vec3d out = std::cos(a) * u + std::sin(a) * v;
    SurfacePoint p;
    switch (shape.kind) {
        case ShapeKind::plane:
            p = {shape.point + dice.between(-size, size) * u + dice.between(-size, size) * v, shape.axis};
            break;
        case ShapeKind::cylinder:
            p = {shape.point + dice.between(0, size) * shape.axis + shape.radius * out, out};
            break;
        case ShapeKind::sphere: {
            const Vec3d n = dice.direction();
            p = {shape.point + shape.radius * n, n};
            break;
        }
        case ShapeKind::cone: {
            const double h = size * std::sqrt(dice.between(0.04, 1));
            p = {shape.point + h * (shape.axis + std::tan(shape.second) * out),
                 std::cos(shape.second) * out - std::sin(shape.second) * shape.axis};
            break;
        }
        case ShapeKind::torus: {
            const double b = dice.between(0, 2 * pi);
            const Vec3d n = std::cos(b) * out + std::sin(b) * shape.axis;
            p = {shape.point + shape.radius * out + shape.second * n, n};
            break;
        }
    }
    p.position = p.position + sigma * dice.normal() * p.normal;
    return p;
}

inline void write_surface_ply(const std::filesystem::path& path, const std::vector<SurfacePoint>& points, bool normals)
{
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size() << "\n";
    for (const char* axis : {"x", "y", "z"}) file << "property double " << axis << "\n";
    if (normals)
        for (const char* axis : {"nx", "ny", "nz"}) file << "property float " << axis << "\n";
    file << "end_header\n";
    for (const SurfacePoint& p : points) {
        file.write(reinterpret_cast<const char*>(p.position.data()), 24);
        for (std::size_t a = 0; normals && a < 3; ++a) {
            const auto n = static_cast<float>(p.normal[a]);
            file.write(reinterpret_cast<const char*>(&n), 4);
        }
    }
}

struct PlacedPoint {
    NodeId node = no_node;
    std::uint32_t number = 0;
    Vec3d position{};
};

inline std::vector<PlacedPoint> all_points(const Tree& tree)
{
    std::vector<PlacedPoint> points;
    const SourceRounding rounding(tree.info());
    for (NodeId node = 0; node < tree.nodes().size(); ++node) {
        const Chunk chunk = tree.read_chunk(node, ColumnSet::only_positions());
        for (std::uint32_t i = 0; i < chunk.points; ++i)
            points.push_back({node, i, rounding(tree.info().grid.to_source(chunk.positions->grid(i)))});
    }
    return points;
}

// The tree NAME.pct of NAME.ply in a folder.
inline std::shared_ptr<const Tree> build_tree_of_ply(const std::filesystem::path& folder, const std::string& name,
                                                     std::uint32_t chunk_points)
{
    BuildOptions options;
    options.chunk_points = chunk_points;
    options.overwrite = true;
    build_tree({folder / (name + ".ply")}, folder / (name + ".pct"), options);
    return Tree::open(folder / (name + ".pct"));
}

inline std::shared_ptr<const Tree> build_surface_tree(const std::filesystem::path& folder,
                                                      const std::vector<SurfacePoint>& points, bool normals = false,
                                                      std::uint32_t chunk_points = 2000)
{
    write_surface_ply(folder / "surface.ply", points, normals);
    return build_tree_of_ply(folder, "surface", chunk_points);
}

inline PointSet set_where(const std::shared_ptr<const Tree>& tree, const std::function<bool(const Vec3d&)>& wanted)
{
    PointSet set(tree);
    for (const PlacedPoint& p : all_points(*tree))
        if (wanted(p.position)) set.combine(SetOperation::add, p.node, {p.number});
    return set;
}

}  // namespace pcm::test
