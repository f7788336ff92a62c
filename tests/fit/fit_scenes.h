// Points on shapes with noise and outliers, whose truth is known.
#pragma once

#include "pcm/fit/shape_fit.h"

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace pcm::scenes {

struct Scene {
    FitPoints points;
    std::vector<std::uint8_t> is_true;  // on the shape
    Shape truth;
    double noise = 0;
    FitPoints true_points() const
    {
        FitPoints result;
        result.origin = points.origin;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (is_true[i]) result.add(points.source(i));
        return result;
    }
};

struct SceneOptions {
    std::size_t points = 3038;
    double outliers = 0.3;  // share of the points, uniform in the box of the shape, widened
    double noise = 0.005;   // along the normal
    std::uint64_t seed = 1;
    double arc = 2 * pi;  // angle of a cylinder, cone or sphere's patch about the axis; of a torus' circle; radians
    double length = 1;    // length of a cylinder or cone along its axis; side of a plane
    Vec3d offset{};       // shift of the whole scene
};

// A place on the shape: u, v uniform in [0, 1].
inline Vec3d place_on(const Shape& shape, const SceneOptions& options, double u, double v, Vec3d& normal)
{
    const Vec3d a = shape.axis, least = std::fabs(a[0]) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d e1 = normalised(cross(a, least)), e2 = cross(a, e1);
    const double angle = options.arc * (u - 0.5), along = options.length * (v - 0.5);
    const Vec3d out = std::cos(angle) * e1 + std::sin(angle) * e2;
    switch (shape.kind) {
        case ShapeKind::plane:
            normal = a;
            return shape.point + (options.length * (u - 0.5)) * e1 + along * e2;
        case ShapeKind::cylinder:
            normal = out;
            return shape.point + along * a + shape.radius * out;
        case ShapeKind::sphere: {
            // A cap of that arc from side to side; the whole for 2 pi.
            const double height = 1 - v * (1 - std::cos(options.arc / 2)), across = std::sqrt(1 - height * height);
            normal = height * a + across * (std::cos(2 * pi * u) * e1 + std::sin(2 * pi * u) * e2);
            return shape.point + shape.radius * normal;
        }
        case ShapeKind::cone: {
            const double h = options.length * (0.2 + v);
            normal = std::cos(shape.second) * out - std::sin(shape.second) * a;
            return shape.point + h * a + (h * std::tan(shape.second)) * out;
        }
        case ShapeKind::torus:
            break;
    }
    const double tube = 2 * pi * v;
    normal = std::cos(tube) * out + std::sin(tube) * a;
    return shape.point + shape.radius * out + shape.second * normal;
}

inline Scene scene_of(const Shape& shape, const SceneOptions& options)
{
    std::mt19937_64 random(options.seed);
    std::normal_distribution<double> gauss;
    std::uniform_real_distribution<double> uniform(0, 1);
    Scene scene;
    scene.truth = shape;
    scene.truth.point = shape.point + options.offset;
    scene.noise = options.noise;
    std::vector<Vec3d> places;
    const auto on = static_cast<std::size_t>(std::lround((1 - options.outliers) * static_cast<double>(options.points)));
    Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    for (std::size_t i = 0; i < on; ++i) {
        Vec3d normal{};
        const Vec3d place = place_on(shape, options, uniform(random), uniform(random), normal);
        places.push_back(place + (options.noise * gauss(random)) * normal);
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], places.back()[k]);
            high[k] = std::max(high[k], places.back()[k]);
        }
    }
    const Vec3d size = high - low;
    const double least = 0.3 * largest_magnitude(size);
    for (std::size_t i = on; i < options.points; ++i) {
        Vec3d place{};
        for (std::size_t k = 0; k < 3; ++k) {
            const double widened = std::max(size[k], least);
            place[k] = (low[k] + high[k]) / 2 + 1.2 * widened * (uniform(random) - 0.5);
        }
        places.push_back(place);
    }
    if (!places.empty()) scene.points.origin = places.front() + options.offset;
    for (std::size_t i = 0; i < places.size(); ++i) {
        scene.points.add(places[i] + options.offset);
        scene.is_true.push_back(i < on);
    }
    return scene;
}

// Least squares of the true points from the truth: the best that can be expected.
inline ShapeFit oracle(const Scene& scene) { return refine_shape(scene.true_points(), scene.truth); }

inline std::vector<Shape> one_of_each_kind()
{
    const Vec3d axis = normalised(Vec3d{1, 2, 3}), point{0.3, 0.1, 0.2};
    return {{ShapeKind::plane, point, axis, 0, 0},
            {ShapeKind::cylinder, point, axis, 0.3, 0},
            {ShapeKind::sphere, point, {0, 0, 1}, 0.4, 0},
            {ShapeKind::cone, point, axis, 0, 0.4},
            {ShapeKind::torus, point, axis, 0.5, 0.15}};
}

}  // namespace pcm::scenes
