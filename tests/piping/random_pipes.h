// Pipes with exact truth: cylinders and elbows as fits would give them, with noise, in any order and direction.
#pragma once

#include "pcm/cloud/numbers.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/shapes/primitive.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace pcm::pipes {

using Random = std::mt19937_64;

inline double uniform(Random& random, double from, double to)
{
    return std::uniform_real_distribution<double>(from, to)(random);
}

inline Vec3d unit_vector(Random& random)
{
    std::normal_distribution<double> normal;
    const double x = normal(random), y = normal(random), z = normal(random);
    return normalised({x, y, z});
}

// About a unit axis.
inline Vec3d turned(const Vec3d& v, const Vec3d& axis, double angle)
{
    return std::cos(angle) * v + std::sin(angle) * cross(axis, v) + ((1 - std::cos(angle)) * dot(axis, v)) * axis;
}

// How wrong fits are, in standard deviations that they state.
struct Noise {
    double place = 0, radius = 0, bend = 0;  // shares of the pipe's radius
    double angle = 0;                        // radians
    double open = 0.2;  // largest share of an elbow's turn, and radii of a pipe, that no points show at either end
};

// Fits of some hundred points to a pipe's radius of 50 mm, noise 1 mm.
inline Noise usual_noise()
{
    Noise noise;
    noise.place = 0.01;
    noise.radius = 0.004;
    noise.bend = 0.02;
    noise.angle = 0.003;
    return noise;
}

// Lays a pipe from a place in a direction; each piece continues the one before it.
class PipeLayer {
public:
    PipeLayer(Random& random, const Noise& noise, const Vec3d& place, const Vec3d& direction, double radius)
        : random_(random), noise_(noise), place_(place), direction_(direction), radius_(radius)
    {
    }

    void straight(double along)
    {
        const double begin = open(radius_), end = open(radius_);
        add_cylinder(place_ + begin * direction_, place_ + (along - end) * direction_);
        skip(along);
    }
    // Without a shape.
    void skip(double along)
    {
        place_ = place_ + along * direction_;
        length_ += along;
    }
    // Counter-clockwise about `axis`, a unit vector across the direction.
    void elbow(const Vec3d& axis, double bend, double turn, bool has_shape = true)
    {
        const Vec3d centre = place_ + bend * cross(axis, direction_);
        if (has_shape) add_torus(centre, axis, (place_ - centre) / bend, bend, turn);
        place_ = centre + turned(place_ - centre, axis, turn);
        direction_ = normalised(turned(direction_, axis, turn));
        length_ += bend * turn;
        ++bends_;
    }
    Vec3d any_axis() { return AxisFrame(direction_).at(uniform(random_, 0, 2 * pi)); }

    const std::vector<Primitive>& parts() const { return parts_; }
    const Vec3d& place() const { return place_; }
    const Vec3d& direction() const { return direction_; }
    double radius() const { return radius_; }
    double length() const { return length_; }
    std::size_t bends() const { return bends_; }
    std::string name = "a";  // what the names of parts begin with

private:
    double open(double unit)
    {
        const double share = uniform(random_, 0, noise_.open);
        return parts_.empty() ? 0 : share * unit;  // the first part shows where the pipe begins
    }
    double normal(double sigma) { return sigma > 0 ? std::normal_distribution<double>(0, sigma)(random_) : 0; }
    Vec3d moved(const Vec3d& p)
    {
        const double sigma = noise_.place * radius_;
        return p + Vec3d{normal(sigma), normal(sigma), normal(sigma)};
    }
    Vec3d tilted(const Vec3d& axis)
    {
        const AxisFrame frame(axis);
        return normalised(axis + normal(noise_.angle) * frame.u + normal(noise_.angle) * frame.v);
    }

    void add(Shape shape, const ShapeBounds& bounds)
    {
        Primitive part;
        part.name = name + std::to_string(parts_.size());
        part.points = 1000;
        part.fit.verdict = FitVerdict::good;
        part.fit.shape = shape;
        part.fit.errors = {noise_.place * radius_, noise_.angle, noise_.radius * radius_, 0};
        if (shape.kind == ShapeKind::torus) {
            part.fit.errors.radius = noise_.bend * radius_;
            part.fit.errors.second = noise_.radius * radius_;
        }
        part.bounds = bounds;
        parts_.push_back(part);
    }

    // The axis runs either way, through any point of it.
    void add_cylinder(const Vec3d& from, const Vec3d& to)
    {
        const bool reversed = random_() % 2;
        const double half = pcm::length(to - from) / 2, shift = uniform(random_, -5, 5) * radius_;
        Shape shape{ShapeKind::cylinder, {}, tilted(reversed ? -1 * direction_ : direction_), 0, 0};
        shape.radius = radius_ + normal(noise_.radius * radius_);
        // Noise is that of the middle, along which a cylinder has none.
        const Vec3d error = moved({0, 0, 0});
        shape.point = 0.5 * (from + to) + (error - dot(error, shape.axis) * shape.axis) + shift * shape.axis;
        ShapeBounds bounds;
        bounds.from = -half - shift;
        bounds.to = half - shift;
        add(shape, bounds);
    }

    void add_torus(const Vec3d& centre, const Vec3d& axis, const Vec3d& begin, double bend, double turn)
    {
        const bool reversed = random_() % 2;
        Shape shape{ShapeKind::torus, moved(centre), tilted(reversed ? -1 * axis : axis), 0, 0};
        shape.radius = bend + normal(noise_.bend * radius_);
        shape.second = radius_ + normal(noise_.radius * radius_);
        ShapeBounds bounds;
        bounds.zero = turned(begin, axis, uniform(random_, 0, 2 * pi));
        bounds.zero = normalised(bounds.zero - dot(bounds.zero, shape.axis) * shape.axis);
        const Vec3d first = turned(begin, axis, uniform(random_, 0, noise_.open) * turn);
        const Vec3d last = turned(begin, axis, turn - uniform(random_, 0, noise_.open) * turn);
        const auto angle_of = [&](const Vec3d& v) {
            const double angle = std::atan2(dot(cross(bounds.zero, v), shape.axis), dot(bounds.zero, v));
            return angle < 0 ? angle + 2 * pi : angle;
        };
        bounds.begin = angle_of(reversed ? last : first);
        bounds.end = angle_of(reversed ? first : last);
        if (bounds.end <= bounds.begin) bounds.end += 2 * pi;
        add(shape, bounds);
    }

    Random& random_;
    Noise noise_;
    Vec3d place_, direction_;
    double radius_;
    double length_ = 0;
    std::size_t bends_ = 0;
    std::vector<Primitive> parts_;
};

// A pipe of straight pieces with this number of elbows of 15 to 120 degrees between them.
inline PipeLayer random_pipe(Random& random, const Noise& noise, const Vec3d& place, double radius, std::size_t bends)
{
    PipeLayer pipe(random, noise, place, unit_vector(random), radius);
    pipe.straight(uniform(random, 4, 40) * radius);
    for (std::size_t i = 0; i < bends; ++i) {
        const Vec3d axis = pipe.any_axis();
        pipe.elbow(axis, uniform(random, 2, 10) * radius, uniform(random, 15, 120) * degree);
        pipe.straight(uniform(random, 4, 40) * radius);
    }
    return pipe;
}

}  // namespace pcm::pipes
