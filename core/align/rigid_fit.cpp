#include "pcm/align/rigid_fit.h"

#include "pcm/cloud/coordinates.h"
#include "pcm/cloud/symmetric_eigen.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace pcm {
namespace {

using Matrix3 = std::array<Vec3d, 3>;

constexpr double thinnest = 1e-6;  // minimum spread across a line, relative to the spread along it
constexpr double epsilon = std::numeric_limits<double>::epsilon();

[[noreturn]] void refuse(const std::string& what, const std::string& hint)
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

std::string number(std::size_t pair) { return "pair " + std::to_string(pair + 1); }

// The points of one cloud, relative to their centroid and in units of `size`.
struct Side {
    const char* name;
    Vec3d centroid{};
    std::vector<Vec3d> points;
    double size = 0;       // the largest coordinate relative to the centroid
    double magnitude = 0;  // the largest coordinate
};

struct Problem {
    Side moving{"moving", {}, {}, 0, 0}, fixed{"fixed", {}, {}, 0, 0};
    std::vector<double> weights;  // their mean, of those above 0, is 1
    double sum = 0;
    std::size_t used = 0;
};

void take_weights(Problem& problem, const std::vector<PointPair>& pairs)
{
    double sum = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const double w = pairs[i].weight;
        require_place(number(i) + ": the place", pairs[i].moving);
        require_place(number(i) + ": the place", pairs[i].fixed);
        if (!(w >= 0) || !std::isfinite(w)) refuse(number(i) + " has a weight that is not 0 or above", "use 1");
        sum += w;
        problem.used += w > 0;
    }
    if (problem.used < 3)
        refuse("a motion needs three pairs of points, and there are " + std::to_string(problem.used),
               "pick points that lie far apart, and not on one line");
    for (const PointPair& pair : pairs)
        problem.weights.push_back(pair.weight / sum * static_cast<double>(problem.used));
    problem.sum = static_cast<double>(problem.used);
}

void take_points(Side& side, const Problem& problem, const std::vector<PointPair>& pairs, Vec3d PointPair::*of)
{
    const Vec3d first = pairs.front().*of;
    Vec3d mean{};
    for (std::size_t i = 0; i < pairs.size(); ++i)
        mean = mean + problem.weights[i] / problem.sum * (pairs[i].*of - first);
    side.centroid = first + mean;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        side.points.push_back(pairs[i].*of - side.centroid);
        side.magnitude = std::max(side.magnitude, largest_magnitude(pairs[i].*of));
        if (problem.weights[i] > 0) side.size = std::max(side.size, largest_magnitude(side.points.back()));
    }
}

// Refuses points that coincide, lie too near together, or on one line.
void check_spread(const Side& side, const Problem& problem, const FitOptions& options)
{
    const std::string cloud = std::string("points of the ") + side.name + " cloud";
    const double rounding = 8 * epsilon * side.magnitude, nearest = std::max(3 * options.pick_error, rounding);
    if (!(side.size > rounding))
        refuse("the " + cloud + " coincide", "pick points that lie far apart, and not on one line");
    for (std::size_t i = 0; i < side.points.size(); ++i)
        for (std::size_t j = i + 1; j < side.points.size(); ++j) {
            if (problem.weights[i] == 0 || problem.weights[j] == 0) continue;
            const double apart = length(side.points[i] - side.points[j]);
            if (apart > rounding) continue;
            refuse(
                "the " + cloud + " in pairs " + std::to_string(i + 1) + " and " + std::to_string(j + 1) + " coincide",
                "delete one of the two pairs");
        }
    SquareMatrix<3> spread{};
    for (std::size_t i = 0; i < side.points.size(); ++i) {
        const Vec3d p = side.points[i] / side.size;
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 3; ++c) spread[r][c] += problem.weights[i] * p[r] * p[c];
    }
    // The values of `spread` are squares: those of thin spreads are summed again across the line.
    const Eigensystem<3> system = eigensystem<3>(spread);
    const Vec3d line = system.vectors[2];
    double along = 0, across = 0;
    for (std::size_t i = 0; i < side.points.size(); ++i) {
        const Vec3d p = side.points[i] / side.size;
        along += problem.weights[i] * dot(p, line) * dot(p, line);
        const Vec3d rest = p - dot(p, line) * line;
        across += problem.weights[i] * dot(rest, rest);
    }
    along = side.size * std::sqrt(along / problem.sum);
    across = side.size * std::sqrt(across / problem.sum);
    if (!(along > nearest))
        refuse("the " + cloud + " lie within " + brief(along) + " of each other, which is not more than they can be " +
                   "picked to",
               "pick points that lie far apart");
    if (!(across > std::max(nearest, thinnest * along)))
        refuse("the " + cloud + " lie on one line: they spread by " + brief(across) + " across it and " + brief(along) +
                   " along it, so that the rotation about it is not determined",
               "pick another pair off the line");
}

struct Quaternion {
    double w = 1;
    Vec3d v{};
};

Quaternion product(const Quaternion& a, const Quaternion& b)
{
    return {a.w * b.w - dot(a.v, b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};
}

Quaternion unit(const Quaternion& q)
{
    const double n = std::sqrt(q.w * q.w + dot(q.v, q.v));
    return {q.w / n, q.v / n};
}

Matrix3 matrix_of(const Quaternion& q)
{
    const double w = q.w, x = q.v[0], y = q.v[1], z = q.v[2];
    return {Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
            Vec3d{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
            Vec3d{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

Vec3d times(const Matrix3& m, const Vec3d& p) { return {dot(m[0], p), dot(m[1], p), dot(m[2], p)}; }

struct Rotation {
    Quaternion q;
    double gap = 0;  // between the two largest eigenvalues, of the largest: 0 where no rotation is best
};

// Horn's matrix; `sign` -1 is for the mirror image of the moving points.
Rotation horn(const Problem& problem, double sign)
{
    Matrix3 s{};
    for (std::size_t i = 0; i < problem.weights.size(); ++i) {
        const Vec3d p = sign / problem.moving.size * problem.moving.points[i];
        const Vec3d q = problem.fixed.points[i] / problem.fixed.size;
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 3; ++c) s[r][c] += problem.weights[i] * p[r] * q[c];
    }
    SquareMatrix<4> n{};
    n[0][0] = s[0][0] + s[1][1] + s[2][2];
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
        n[0][a + 1] = n[a + 1][0] = s[b][c] - s[c][b];
        n[a + 1][a + 1] = s[a][a] - s[b][b] - s[c][c];
        n[a + 1][b + 1] = n[b + 1][a + 1] = s[a][b] + s[b][a];
    }
    const Eigensystem<4> system = eigensystem<4>(n);
    const auto& v = system.vectors[3];
    const double largest = std::max(std::fabs(system.values[0]), std::fabs(system.values[3]));
    return {unit({v[0], {v[1], v[2], v[3]}}), largest > 0 ? (system.values[3] - system.values[2]) / largest : 0};
}

// Sum of w (|p|^2 I - p p^T) over the turned points: the normal matrix of a small rotation.
Eigensystem<3> inertia(const Problem& problem, const Matrix3& rotation)
{
    SquareMatrix<3> h{};
    for (std::size_t i = 0; i < problem.weights.size(); ++i) {
        const Vec3d p = times(rotation, problem.moving.points[i] / problem.moving.size);
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 3; ++c)
                h[r][c] += problem.weights[i] * ((r == c ? dot(p, p) : 0) - p[r] * p[c]);
    }
    return eigensystem<3>(h);
}

double scale_of(const Problem& problem, const Matrix3& rotation)
{
    double above = 0, below = 0;
    for (std::size_t i = 0; i < problem.weights.size(); ++i) {
        const Vec3d p = times(rotation, problem.moving.points[i] / problem.moving.size);
        above += problem.weights[i] * dot(problem.fixed.points[i] / problem.fixed.size, p);
        below += problem.weights[i] * dot(p, p);
    }
    return above / below * (problem.fixed.size / problem.moving.size);
}

// The eigenvector of a nearly singular matrix has lost digits, which the residuals still have.
Quaternion improved(const Problem& problem, Quaternion q, bool with_scale)
{
    for (int step = 0; step < 3; ++step) {
        const Matrix3 rotation = matrix_of(q);
        const double scale = with_scale ? scale_of(problem, rotation) : 1;
        const Eigensystem<3> system = inertia(problem, rotation);
        Vec3d turn{};
        for (std::size_t i = 0; i < problem.weights.size(); ++i) {
            const Vec3d p = times(rotation, problem.moving.points[i]);
            const Vec3d rest = problem.fixed.points[i] - scale * p;
            turn = turn + problem.weights[i] * cross(p / problem.moving.size, rest / (scale * problem.moving.size));
        }
        Vec3d omega{};
        for (std::size_t a = 0; a < 3; ++a) {
            if (!(system.values[a] > 0)) return q;
            omega = omega + dot(system.vectors[a], turn) / system.values[a] * system.vectors[a];
        }
        if (!(length(omega) < 1e-3)) return q;  // far from linear: the closed form stands
        q = unit(product({1, 0.5 * omega}, q));
    }
    return q;
}

double rms_of(const Problem& problem, const Matrix3& rotation, double scale, double sign)
{
    double sum = 0;
    for (std::size_t i = 0; i < problem.weights.size(); ++i) {
        const Vec3d rest =
            (problem.fixed.points[i] - sign * scale * times(rotation, problem.moving.points[i])) / problem.fixed.size;
        sum += problem.weights[i] * dot(rest, rest);
    }
    return problem.fixed.size * std::sqrt(sum / problem.sum);
}

// The rotation in `fit`, as far as it is determined.
Quaternion find_rotation(const Problem& problem, const FitOptions& options)
{
    const Rotation found = horn(problem, 1), mirrored = horn(problem, -1);
    const auto fit_of = [&](const Rotation& rotation, double sign) {
        const Matrix3 matrix = matrix_of(rotation.q);
        return rms_of(problem, matrix, options.scale ? std::fabs(scale_of(problem, matrix)) : 1, sign);
    };
    const double motion = fit_of(found, 1), mirror = fit_of(mirrored, -1);
    const double rounding = 64 * epsilon * std::max(problem.moving.magnitude, problem.fixed.magnitude);
    if (motion > 2 * mirror + 4 * options.pick_error + rounding)
        refuse("the pairs fit a mirror image (within " + brief(mirror) + ") and no motion (within " + brief(motion) +
                   "): one of the clouds is mirrored, or partners were exchanged",
               "check the pairs; a left-handed file needs one axis negated first");
    if (!(found.gap > 1e-13))
        refuse("the pairs do not determine a rotation: turned in different ways they fit equally badly",
               "check that the points of each pair are the same place");
    return improved(problem, found.q, options.scale);
}

void put_uncertainty(RigidFit& fit, const Problem& problem, const FitOptions& options, const Matrix3& rotation)
{
    const double freedom = 3 * static_cast<double>(problem.used) - (options.scale ? 7 : 6);
    const double from_residuals = fit.rms * std::sqrt(problem.sum / freedom);
    fit.coordinate_error = std::max(from_residuals, std::sqrt(2.0) * options.pick_error);
    const Eigensystem<3> system = inertia(problem, rotation);
    const double arm = fit.scale * problem.moving.size;  // lever arm of a turned point, in the fixed cloud's units
    fit.variance_of_shift = 1 / problem.sum;
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 3; ++c)
                fit.covariance_of_rotation[r][c] +=
                    system.vectors[a][r] * system.vectors[a][c] / system.values[a] / (arm * arm);
    fit.weakest_axis = system.vectors[0];
    fit.angle_error = fit.coordinate_error / (arm * std::sqrt(system.values[0]));
}

}  // namespace

double RigidFit::error_at(const Vec3d& moving) const
{
    const Vec3d x = motion(moving) - motion.target;
    SquareMatrix<3> covariance{};
    // The place moves by shift + turn x arm. A fitted scale moves it along the arm, by less than the turn does across
    // it.
    const auto column = [&](std::size_t a) {
        Vec3d e{};
        e[a] = 1;
        return cross(e, x);
    };
    const std::array<Vec3d, 3> turned{column(0), column(1), column(2)};
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) {
            covariance[r][c] = (r == c ? variance_of_shift : 0);
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j)
                    covariance[r][c] += turned[i][r] * covariance_of_rotation[i][j] * turned[j][c];
        }
    return coordinate_error * std::sqrt(std::max(eigensystem<3>(covariance).values[2], 0.0));
}

double RigidFit::largest_error(const Box3d& box) const
{
    // The variance along any direction is a convex function of the place.
    double largest = 0;
    for (unsigned corner = 0; corner < 8 && !box.empty(); ++corner) {
        Vec3d p;
        for (std::size_t a = 0; a < 3; ++a) p[a] = corner >> a & 1u ? box.max[a] : box.min[a];
        largest = std::max(largest, error_at(p));
    }
    return largest;
}

RigidFit fit_motion(const std::vector<PointPair>& pairs, const FitOptions& options)
{
    if (!(options.pick_error >= 0) || !std::isfinite(options.pick_error))
        refuse("the uncertainty of the picked points is not 0 or above", "give it in source units");
    Problem problem;
    take_weights(problem, pairs);
    take_points(problem.moving, problem, pairs, &PointPair::moving);
    take_points(problem.fixed, problem, pairs, &PointPair::fixed);
    check_spread(problem.moving, problem, options);
    check_spread(problem.fixed, problem, options);
    const Quaternion q = find_rotation(problem, options);
    const Matrix3 rotation = matrix_of(q);

    RigidFit fit;
    fit.pairs_scale = scale_of(problem, rotation);
    if (options.scale) {
        if (!(fit.pairs_scale > 0))
            refuse("the pairs determine no scale above 0", "check that the points of each pair are the same place");
        fit.scale = fit.pairs_scale;
    }
    for (std::size_t r = 0; r < 3; ++r) fit.motion.linear[r] = fit.scale * rotation[r];
    fit.motion.pivot = problem.moving.centroid;
    fit.motion.target = problem.fixed.centroid;
    fit.shift = fit.motion.target - fit.motion.pivot;
    const double sine = length(q.v);
    if (sine > 0) fit.axis = (q.w < 0 ? -1 : 1) / sine * q.v;
    fit.radians = 2 * std::atan2(sine, std::fabs(q.w));
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        fit.offsets.push_back(problem.fixed.points[i] - times(fit.motion.linear, problem.moving.points[i]));
        fit.residuals.push_back(length(fit.offsets.back()));
    }
    fit.rms = rms_of(problem, rotation, fit.scale, 1);
    put_uncertainty(fit, problem, options, rotation);
    return fit;
}

}  // namespace pcm
