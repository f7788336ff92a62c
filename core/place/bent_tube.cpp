#include "pcm/place/bent_tube.h"

#include "pcm/cloud/numbers.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace pcm {
namespace {

// Centre along three axes, tilt of the axis along two of them, radii of the bend and of the tube, ends.
constexpr int parameters = 9;
enum Parameter { centre, tilt = 3, bend = 5, tube = 6, first_end = 7, last_end = 8 };
constexpr int most_steps = 12;
constexpr std::size_t most_at_first = 400;           // points for which the nearest minimum of each start is found
constexpr double first_shares[] = {0.1, 0.25, 0.4};  // shares of the points' angle outside the ends of a start
constexpr double wider = 2;                          // farthest distances that points of a start have
constexpr double enough_gain = 1e-4;  // share of the sum of squares; a step that gains less is the last one

using Numbers = Eigen::Matrix<double, parameters, 1>;
using Products = Eigen::Matrix<double, parameters, parameters>;

// From 0 to 2 pi.
double turned(double angle) { return angle < 0 ? angle + 2 * pi : angle; }

class TubeFit {
public:
    TubeFit(const Shape& torus, const Vec3d& start, const std::vector<Vec3d>& points, double farthest)
        : farthest_(farthest),
          origin_(torus.point),
          axis_(torus.axis),
          u_(normalised(start - dot(start, torus.axis) * torus.axis)),
          v_(cross(axis_, u_))
    {
        for (const Vec3d& p : points) {
            const Vec3d d = p - origin_;
            points_.push_back({dot(d, u_), dot(d, v_), dot(d, axis_)});
        }
    }

    // From these numbers to the nearest minimum; returns the sum of squares there.
    double improve(Numbers& at)
    {
        double squares = linearise(at), damping = 1e-3;
        for (int step = 0; step < most_steps; ++step) {
            Products damped = products_;
            damped.diagonal() += damping * products_.diagonal();
            damped.diagonal().array() += 1e-12 * products_.trace();
            const Numbers next = at - damped.ldlt().solve(pulls_);
            const bool is_torus = next.allFinite() && next[tube] > 0 && next[tube] < next[bend];
            const double there = is_torus ? squares_of(next) : infinity;
            if (!(there < squares)) {
                damping *= 10;
                continue;
            }
            const bool is_enough = squares - there < enough_gain * squares;
            at = next;
            squares = there;
            if (is_enough) break;
            damping /= 5;
            linearise(at);
        }
        return squares;
    }

    BentTube tube_at(const Numbers& at, double squares)
    {
        linearise(at);
        BentTube result;
        const Vec3d axis = axis_at(at);
        result.torus.kind = ShapeKind::torus;
        result.torus.point = origin_ + at[0] * u_ + at[1] * v_ + at[2] * axis_;
        result.torus.axis = axis[0] * u_ + axis[1] * v_ + axis[2] * axis_;
        result.torus.radius = at[bend];
        result.torus.second = at[tube];
        result.from = at[first_end];
        result.to = at[last_end];
        result.squares = squares;
        Products damped = products_;
        damped.diagonal().array() += 1e-12 * products_.trace();
        const Products inverse = damped.ldlt().solve(Products::Identity());
        result.on_tube = on_tube_;
        result.variance = squares_on_tube_ / static_cast<double>(std::max<std::size_t>(on_tube_, 1));
        const double variance = result.variance;
        const auto error = [&](Parameter end) {
            return products_(end, end) > 0 ? std::sqrt(variance * inverse(end, end)) : infinity;
        };
        result.from_error = error(first_end);
        result.to_error = error(last_end);
        return result;
    }

private:
    static Vec3d axis_at(const Numbers& at) { return normalised({at[tilt], at[tilt + 1], 1}); }

    // A tube of these numbers, for many places.
    struct Tube {
        explicit Tube(const Numbers& at)
            : numbers(at),
              middle{at[0], at[1], at[2]},
              axis(axis_at(at)),
              u(normalised(Vec3d{1, 0, 0} - axis[0] * axis)),
              v(cross(axis, u)),
              first{std::cos(at[first_end]), std::sin(at[first_end])},
              last{std::cos(at[last_end]), std::sin(at[last_end])}
        {
        }
        // Signed distance of a place along the three axes from the tube.
        double distance(const Vec3d& place) const
        {
            const Vec3d d = place - middle;
            const double x = dot(d, u), y = dot(d, v), h = dot(d, axis);
            const double angle = turned(std::atan2(y, x));
            if (angle >= numbers[first_end] && angle <= numbers[last_end])
                return std::hypot(std::hypot(x, y) - numbers[bend], h) - numbers[tube];
            const std::array<double, 2>& end = angle < numbers[first_end] ? first : last;
            const double out = x * end[0] + y * end[1] - numbers[bend];  // across the tangent at the end
            return std::hypot(out, h) - numbers[tube];
        }
        const Numbers numbers;
        const Vec3d middle, axis, u, v;
        const std::array<double, 2> first, last;  // cosine and sine of the ends
    };

    double squares_of(const Numbers& at) const
    {
        const Tube tube(at);
        double squares = 0;
        for (const Vec3d& p : points_) squares += std::pow(std::min(std::fabs(tube.distance(p)), farthest_), 2);
        return squares;
    }

    // Normal equations by differences.
    double linearise(const Numbers& at)
    {
        Numbers step = Numbers::Constant(1e-6);
        for (const int length : {int(centre), centre + 1, centre + 2, int(bend), int(tube)}) step[length] *= at[bend];
        std::vector<Tube> moved;
        for (int j = 0; j < parameters; ++j) {
            Numbers next = at;
            next[j] += step[j];
            moved.emplace_back(next);
        }
        const Tube unmoved(at);
        products_.setZero();
        pulls_.setZero();
        squares_on_tube_ = 0;
        on_tube_ = 0;
        for (const Vec3d& p : points_) {
            const double here = unmoved.distance(p);
            if (!(std::fabs(here) <= farthest_)) continue;
            Numbers by;
            for (int j = 0; j < parameters; ++j)
                by[j] = (moved[static_cast<std::size_t>(j)].distance(p) - here) / step[j];
            products_ += by * by.transpose();
            pulls_ += here * by;
            squares_on_tube_ += here * here;
            ++on_tube_;
        }
        return squares_of(at);
    }

    const double farthest_;
    const Vec3d origin_, axis_, u_, v_;
    std::vector<Vec3d> points_;  // about the first centre, along the three axes
    double squares_on_tube_ = 0;
    std::size_t on_tube_ = 0;
    Products products_ = Products::Zero();
    Numbers pulls_ = Numbers::Zero();
};

}  // namespace

double angle_about(const Shape& torus, const Vec3d& start, const Vec3d& p)
{
    const Vec3d d = p - torus.point;
    const Vec3d u = normalised(start - dot(start, torus.axis) * torus.axis);
    return turned(std::atan2(dot(d, cross(torus.axis, u)), dot(d, u)));
}

std::vector<BendEnds> ends_between(double low, double high)
{
    std::vector<BendEnds> ends;
    for (const double low_share : first_shares)
        for (const double high_share : first_shares)
            ends.push_back({low + low_share * (high - low), high - high_share * (high - low)});
    return ends;
}

std::optional<BentTube> fit_bent_tube(const Shape& torus, const Vec3d& start, const std::vector<BendEnds>& ends,
                                      const std::vector<Vec3d>& points, double farthest)
{
    std::vector<Vec3d> few;
    for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / most_at_first) few.push_back(points[i]);
    TubeFit near(torus, start, few, farthest), wide(torus, start, few, wider * farthest);
    std::optional<std::pair<double, Numbers>> best;
    const auto take_better = [&](const Numbers& from) {
        Numbers at = from;
        const double squares = near.improve(at);
        if (at[first_end] < at[last_end] && (!best || squares < best->first)) best = {squares, at};
    };
    for (const BendEnds& one : ends) {
        Numbers at;
        at << 0, 0, 0, 0, 0, torus.radius, torus.second, one.from, one.to;
        take_better(at);
        wide.improve(at);
        take_better(at);
    }
    if (!best) return {};
    TubeFit fit(torus, start, points, farthest);
    const double squares = fit.improve(best->second);
    if (!(best->second[first_end] < best->second[last_end])) return {};
    return fit.tube_at(best->second, squares);
}

}  // namespace pcm
