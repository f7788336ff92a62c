#include "pcm/shapes/shape_mesh.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

namespace pcm {
namespace {

struct Mesh {
    std::vector<MeshFace> faces;
    std::map<std::pair<Vec3d, Vec3d>, int> edges;  // directed

    Mesh(const Shape& shape, const ShapeBounds& bounds, const MeshOptions& options)
    {
        mesh_shape(shape, bounds, options, [&](const MeshFace& face) {
            faces.push_back(face);
            for (std::size_t k = 0; k < 4; ++k)
                if (face[k] != face[(k + 1) % 4]) ++edges[{face[k], face[(k + 1) % 4]}];
        });
    }
    // Every edge once in each direction.
    bool closed() const
    {
        for (const auto& [edge, count] : edges) {
            const auto back = edges.find({edge.second, edge.first});
            if (count != 1 || back == edges.end() || back->second != 1) return false;
        }
        return !edges.empty();
    }
    // The volume that the faces enclose, by tetrahedra from a place near: above 0 where faces look outwards.
    double volume(const Vec3d& near) const
    {
        double sum = 0;
        for (const MeshFace& f : faces)
            for (std::size_t k = 1; k + 1 < 4; ++k) sum += dot(f[0] - near, cross(f[k] - near, f[k + 1] - near)) / 6;
        return sum;
    }
};

// Farthest distance of places on faces from the surface, flat caps (whose corners are all on one circle) left out.
double farthest(const Shape& shape, const Mesh& mesh, const ShapeBounds& bounds)
{
    double most = 0;
    for (const MeshFace& f : mesh.faces) {
        if (shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::cone) {
            const auto at = [&](const Vec3d& p) { return dot(shape.axis, p - shape.point); };
            if (std::fabs(at(f[0]) - at(f[1])) + std::fabs(at(f[0]) - at(f[2])) < 1e-9 * (bounds.to - bounds.from))
                continue;
        }
        for (int i = 0; i <= 4; ++i)
            for (int j = 0; j <= 4; ++j) {
                const double a = i / 4.0, b = j / 4.0;
                const Vec3d p = (1 - a) * (1 - b) * f[0] + a * (1 - b) * f[1] + a * b * f[2] + (1 - a) * b * f[3];
                most = std::max(most, distance_to(shape, p));
            }
    }
    return most;
}

struct Case {
    const char* shape;
    double from, to, volume;
};
const Case cases[] = {
    {"cylinder 1 2 3 1 2 3 0.3", -1, 4, pi * 0.09 * 5},
    {"cone 1 2 3 0 -2 3 20", 0.5, 2, pi / 3 * (8 - 0.125) * 0.13247433143179424},  // tan(20 degrees)^2
    {"cone 1 2 3 0 -2 3 20", 0, 2, pi / 3 * 8 * 0.13247433143179424},
    {"sphere 1 2 3 0.75", 0, 0, 4 * pi / 3 * 0.421875},
    {"torus 1 2 3 3 2 1 1.5 0.4", 0, 0, 2 * pi* pi * 1.5 * 0.16},
};

TEST(ShapeMeshes, AreClosedLookOutwardsAndKeepTheChord)
{
    for (const Case& one : cases)
        for (const double chord : {0.0, 0.03, 0.001}) {
            const Shape shape = parse_shape(one.shape);
            ShapeBounds bounds;
            bounds.from = one.from;
            bounds.to = one.to;
            const Mesh mesh(shape, bounds, {chord, false});
            EXPECT_TRUE(mesh.closed()) << one.shape;
            const double radius = shape.kind == ShapeKind::torus  ? shape.second
                                  : shape.kind == ShapeKind::cone ? one.to * std::tan(shape.second)
                                                                  : shape.radius;
            const bool is_round = shape.kind == ShapeKind::sphere || shape.kind == ShapeKind::torus;
            const double allowed = chord > 0 ? chord : radius / (is_round ? 50 : 100);
            EXPECT_LE(farthest(shape, mesh, bounds), allowed * (1 + 1e-9)) << one.shape << " " << chord;
            if (chord < 0.01)
                EXPECT_GT(farthest(shape, mesh, bounds), allowed * 0.3) << "wastefully fine " << one.shape;
            EXPECT_LT(mesh.volume(shape.point), one.volume);
            EXPECT_GT(mesh.volume(shape.point), one.volume * (1 - 4 * allowed / radius)) << one.shape;
            for (const MeshFace& face : mesh.faces)
                for (const Vec3d& corner : face) EXPECT_LT(distance_to(shape, corner), 1e-14);
        }
}

TEST(ShapeMeshes, APartOfATorusHasCaps)
{
    const Shape torus = parse_shape("torus 1 2 3 0 0 1 1.5 0.4");
    ShapeBounds bounds;
    bounds.zero = {0, 1, 0};
    bounds.begin = 6;
    bounds.end = 6 + pi / 2;
    const Mesh mesh(torus, bounds, {1e-4, false});
    EXPECT_TRUE(mesh.closed());
    EXPECT_NEAR(mesh.volume(torus.point), 2 * pi * pi * 1.5 * 0.16 / 4, 0.002);
    for (const MeshFace& face : mesh.faces)
        for (const Vec3d& corner : face) {
            double angle = std::atan2(-(corner[0] - 1), corner[1] - 2);  // from +y, counter-clockwise
            while (angle < 6 - 1e-9) angle += 2 * pi;
            EXPECT_LE(angle, 6 + pi / 2 + 1e-9);
        }
}

TEST(ShapeMeshes, ArcsOfCylindersAreOpenWhenAskedFor)
{
    const Shape pipe = parse_shape("cylinder 0 0 0 0 0 1 1");
    ShapeBounds bounds;
    bounds.from = 0;
    bounds.to = 2;
    bounds.zero = {1, 0, 0};
    bounds.begin = 0;
    bounds.end = pi;
    const Mesh arc(pipe, bounds, {1e-3, true}), whole(pipe, bounds, {1e-3, false});
    EXPECT_FALSE(arc.closed());
    EXPECT_TRUE(whole.closed());
    for (const MeshFace& face : arc.faces)
        for (const Vec3d& corner : face) EXPECT_GE(corner[1], -1e-12);
    bounds.end = 2 * pi;  // all around: whole
    EXPECT_TRUE(Mesh(pipe, bounds, {1e-3, true}).closed());
}

TEST(ShapeMeshes, WhatHasNoLengthHasNone)
{
    EXPECT_TRUE(Mesh(parse_shape("cylinder 0 0 0 0 0 1 1"), {}, {}).faces.empty());
    EXPECT_TRUE(Mesh(parse_shape("plane 0 0 0 0 0 1"), {}, {}).faces.empty());
    EXPECT_THROW(Mesh(parse_shape("sphere 0 0 0 1"), {}, {1e-9, false}), Error);
    EXPECT_THROW(Mesh(parse_shape("sphere 0 0 0 1"), {}, {std::nan(""), false}), Error);
}

// Numbers that do not make a shape are refused, not drawn, wherever they come from; for planes, which have no mesh,
// too.
TEST(ShapeMeshes, OfNoShapeAreRefused)
{
    const double nan = std::nan(""), infinity = HUGE_VAL;
    const Vec3d up{0, 0, 1};
    std::vector<Shape> bad{{ShapeKind::plane, {nan, 0, 0}, up, 0, 0},
                           {ShapeKind::plane, {0, 0, 0}, {0, 0, 0}, 0, 0},
                           {ShapeKind::sphere, {0, infinity, 0}, up, 1, 0},
                           {ShapeKind::cylinder, {0, 0, 0}, {0, 0, 0}, 1, 0},
                           {ShapeKind::cylinder, {0, 0, 0}, {0, nan, 0}, 1, 0},
                           {ShapeKind::torus, {0, 0, 0}, up, 1, 1},
                           {ShapeKind::torus, {0, 0, 0}, up, 1, 0},
                           {ShapeKind::torus, {0, 0, 0}, up, 1, nan}};
    for (const double radius : {0.0, -1.0, nan, infinity})
        for (const ShapeKind kind : {ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::torus})
            bad.push_back({kind, {0, 0, 0}, up, radius, 0.1});
    for (const double angle : {0.0, -0.1, pi / 2, nan}) bad.push_back({ShapeKind::cone, {0, 0, 0}, up, 0, angle});
    ShapeBounds bounds;
    bounds.from = 1;
    bounds.to = 2;
    for (const Shape& shape : bad) {
        SCOPED_TRACE(text_of(shape));
        const auto code_of = [&](const auto& make) {
            try {
                make();
            } catch (const Error& error) {
                return error.code();
            }
            return ErrorCode::io;
        };
        EXPECT_EQ(code_of([&] { Mesh(shape, bounds, {}); }), ErrorCode::invalid_argument);
        EXPECT_EQ(code_of([&] { lines_of(shape, bounds, {}); }), ErrorCode::invalid_argument);
    }
}

double area_of(const std::vector<Vec3d>& outline, const std::vector<std::array<std::uint32_t, 3>>& triangles)
{
    double sum = 0;
    for (const auto& t : triangles) {
        const double area = cross(outline[t[1]] - outline[t[0]], outline[t[2]] - outline[t[0]])[2] / 2;
        EXPECT_GT(area, 0);
        sum += area;
    }
    return sum;
}

TEST(Outlines, AreDividedIntoTriangles)
{
    const Vec3d up{0, 0, 1};
    const std::vector<Vec3d> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    EXPECT_EQ(triangulate_outline(square, up).size(), 2u);
    // Corners along the sides, and a slot.
    std::vector<Vec3d> comb;
    for (int i = 0; i <= 10; ++i) comb.push_back({1.0 * i, 0, 0});
    for (int i = 10; i >= 0; --i) comb.push_back({1.0 * i, i % 2 ? 1.0 : 5.0, 0});
    const auto triangles = triangulate_outline(comb, up);
    EXPECT_EQ(triangles.size(), comb.size() - 2);
    EXPECT_NEAR(area_of(comb, triangles), 30, 1e-12);
    // A star with random spikes.
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> radius(0.05, 1);
    for (int round = 0; round < 50; ++round) {
        std::vector<Vec3d> star;
        double area = 0;
        const int count = 3 + round * 4;
        for (int i = 0; i < count; ++i) {
            const double turn = 2 * pi * i / count, r = radius(random);
            star.push_back({r * std::cos(turn) + 5e5, r * std::sin(turn) + 48e5, 0});
        }
        for (int i = 0; i < count; ++i) area += cross(star[i] - star[0], star[(i + 1) % count] - star[0])[2] / 2;
        const auto parts = triangulate_outline(star, up);
        EXPECT_EQ(parts.size(), star.size() - 2);
        EXPECT_NEAR(area_of(star, parts), area, 1e-7);
    }
}

TEST(ShapeLines, LieOnTheSurfaceAndAreEdgesOfTheMesh)
{
    const std::size_t rims[] = {2, 2, 1, 2, 4}, more[] = {4, 4, 4, 0, 4};  // closed ones along, all others
    for (std::size_t c = 0; c < std::size(cases); ++c)
        for (const double chord : {0.0, 0.03}) {
            const Shape shape = parse_shape(cases[c].shape);
            ShapeBounds bounds;
            bounds.from = cases[c].from;
            bounds.to = cases[c].to;
            const Mesh mesh(shape, bounds, {chord, false});
            const ShapeLines found = lines_of(shape, bounds, {chord, false});
            EXPECT_EQ(found.lines.size(), rims[c] + more[c]) << cases[c].shape;
            EXPECT_EQ(found.circles.size(), shape.kind == ShapeKind::sphere ? 1u : 0u);
            for (const ShapeLines::Line& line : found.lines) {
                ASSERT_GE(line.corners.size(), line.closed ? 8u : 2u);
                for (const Vec3d& p : line.corners) EXPECT_LT(std::fabs(distance_to(shape, p)), 1e-12);
                if (shape.kind != ShapeKind::cylinder && shape.kind != ShapeKind::cone) continue;
                for (std::size_t i = 0; i + (line.closed ? 0 : 1) < line.corners.size(); ++i) {
                    const Vec3d &a = line.corners[i], &b = line.corners[(i + 1) % line.corners.size()];
                    EXPECT_TRUE(mesh.edges.count({a, b}) || mesh.edges.count({b, a})) << cases[c].shape;
                }
            }
        }
}

TEST(ShapeLines, CirclesAreThoseAcrossZ)
{
    ShapeBounds bounds;
    bounds.from = -1;
    bounds.to = 4;
    ShapeLines found = lines_of(parse_shape("cylinder 1 2 3 0 0 -1 0.3"), bounds, {});
    ASSERT_EQ(found.circles.size(), 2u);
    EXPECT_EQ(found.circles[0].centre, (Vec3d{1, 2, 4}));
    EXPECT_EQ(found.circles[1].centre, (Vec3d{1, 2, -1}));
    EXPECT_EQ(found.circles[1].radius, 0.3);
    EXPECT_EQ(found.lines.size(), 4u);
    EXPECT_TRUE(lines_of(parse_shape("cylinder 1 2 3 1e-9 0 -1 0.3"), bounds, {}).circles.empty());
    // A part of the circle: open arcs, and a straight line at both ends of it.
    bounds.zero = {1, 0, 0};
    bounds.begin = 0;
    bounds.end = pi / 2;
    found = lines_of(parse_shape("cylinder 1 2 3 0 0 1 0.3"), bounds, {0.0001, true});
    EXPECT_TRUE(found.circles.empty());
    ASSERT_EQ(found.lines.size(), 7u);
    for (const ShapeLines::Line& line : found.lines) EXPECT_FALSE(line.closed);
    EXPECT_LT(length(found.lines[0].corners.front() - Vec3d{1.3, 2, 2}), 1e-12);
    EXPECT_LT(length(found.lines[0].corners.back() - Vec3d{1, 2.3, 2}), 1e-12);
    EXPECT_LT(length(found.lines[6].corners.back() - Vec3d{1, 2.3, 7}), 1e-12);
    EXPECT_THROW(lines_of(parse_shape("sphere 1 2 3 1"), bounds, {-1, false}), Error);
    EXPECT_THROW(lines_of(parse_shape("sphere 1 2 3 1"), bounds, {1e-30, false}), Error);
}

TEST(Outlines, ThatCrossThemselvesHaveNoTriangles)
{
    const Vec3d up{0, 0, 1};
    EXPECT_TRUE(triangulate_outline({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}, up).empty());
    EXPECT_TRUE(triangulate_outline({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, up).empty());
    EXPECT_TRUE(triangulate_outline({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}}, up).empty());
    EXPECT_TRUE(triangulate_outline({{0, 0, 0}, {1, 0, 0}}, up).empty());
}

}  // namespace
}  // namespace pcm
