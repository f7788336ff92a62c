#include "pcm/place/near_bend.h"

#include "pcm/fit/tuning.h"
#include "pcm/place/error_agreement.h"
#include "pcm/place/grow_shape.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/axis_frame.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pcm {
namespace {

constexpr int straight = 5, bent = 7;     // numbers of a straight pipe, and of a bent one
constexpr int most_starts = 24;           // beginnings of a bend within the reach to both sides
constexpr int halvings = 3;               // number of halvings of the distance between them, around the best one
constexpr int rounds = 5;                 // in which points are chosen
constexpr double first_bent = 0.3;        // part of the reach beyond the beginning of a bend that it is fitted to first
constexpr std::size_t least_points = 60;  // to compare pipes
constexpr double wide_bend = 3;           // radius of an elbow, radii of its tube
constexpr double interval = 3;            // standard deviations of the beginning of a bend
constexpr double least_narrow = 0.3;      // inner radius of a bend, radii of its axis

// A point about the pipe's axis, lengths in units of the reach.
struct PipePoint {
    double way = 0;  // from the place, in the direction of the bend
    double cosine = 0, sine = 0;
    double distance = 0;  // source units
};

using Numbers = Eigen::Matrix<double, bent, 1>;
using Products = Eigen::Matrix<double, bent, bent>;

struct PipeFit {
    double start = 0;  // beginning of the bend, in units of the reach
    Numbers numbers = Numbers::Zero();
    double misfit = infinity;
};

bool is_better(const PipeFit& a, const PipeFit& b) { return a.misfit < b.misfit; }

class BendSearch {
public:
    BendSearch(const PipeAtPlace& pipe, const std::vector<Vec3d>& points, double direction)
        : pipe_(pipe), reach_(reach_of_bends(pipe)), most_(fit_tuning().thresholds.inlier_noises * pipe.noise)
    {
        const AxisFrame frame(pipe.cylinder.axis);
        for (const Vec3d& p : points) {
            const double way = direction * dot(p - pipe.place, frame.axis) / reach_;
            if (!(std::fabs(way) <= 1)) continue;
            const Vec3d d = p - pipe.cylinder.point;
            const double x = dot(d, frame.u), y = dot(d, frame.v), out = std::hypot(x, y);
            if (out > 0) points_.push_back({way, x / out, y / out, out - pipe.cylinder.radius});
        }
    }

    // Bent pipes in the order of the places where they begin, which are closest together next to the best one. Empty
    // for few points.
    std::vector<PipeFit> bent_pipes() const
    {
        std::vector<PipeFit> all;
        if (points_.size() < least_points) return all;
        double step = 2.0 / most_starts;
        for (int k = 0; k < most_starts; ++k) all.push_back(fitted(bent, step * (k + 0.5) - 1));
        for (int halving = 0; halving < halvings; ++halving) {
            step /= 2;
            const double best = std::min_element(all.begin(), all.end(), is_better)->start;
            for (const double start : {best - step, best + step}) all.push_back(fitted(bent, start));
        }
        std::sort(all.begin(), all.end(), [](const PipeFit& a, const PipeFit& b) { return a.start < b.start; });
        return all;
    }

    PipeFit straight_pipe() const { return fitted(straight, 0); }

    double curvature_of(const Numbers& at) const { return 2 * std::hypot(at[5], at[6]) / (reach_ * reach_); }

    // How far neighbours share their errors about a bent pipe, as a factor on variances.
    double shared(const PipeFit& fit) const
    {
        const double radius = pipe_.cylinder.radius / reach_;
        ErrorAgreement errors({-1, -radius, -radius}, 2 / place_tuning().kinds.agreement_cubes);
        for (const PipePoint& p : points_) {
            const double left = p.distance - predicted(fit.numbers, bent, fit.start, p);
            if (std::fabs(left) <= most_) errors.add({p.way, radius * p.cosine, radius * p.sine}, left);
        }
        return std::pow(errors.factor(), 2);
    }

    double reach() const { return reach_; }

private:
    // Derivatives of the distance. An elbow is narrower on its inner side than its axis is, and wider on its outer one.
    Numbers row(const Numbers& at, int numbers, double start, const PipePoint& p) const
    {
        Numbers by = Numbers::Zero();
        by << 1, p.cosine, p.sine, p.way * p.cosine, p.way * p.sine, 0, 0;
        const double beyond = p.way - start;
        if (numbers == straight || beyond <= 0) return by;
        const double inwards = 2 * (at[5] * p.cosine + at[6] * p.sine) / (reach_ * reach_) * pipe_.cylinder.radius;
        const double size = beyond * beyond / std::max(1 - inwards, least_narrow);
        by[5] = size * p.cosine;
        by[6] = size * p.sine;
        return by;
    }

    // Distance of the point from the cylinder, if it lies on the pipe of these numbers: exact for the bend, which is a
    // torus that touches the cylinder where it begins.
    double predicted(const Numbers& at, int numbers, double start, const PipePoint& p) const
    {
        const double unbent = at[0] + at[1] * p.cosine + at[2] * p.sine + p.way * (at[3] * p.cosine + at[4] * p.sine);
        const double beyond = p.way - start, size = std::hypot(at[5], at[6]);
        if (numbers == straight || beyond <= 0 || !(size > 0)) return unbent;
        const double out = pipe_.cylinder.radius + p.distance, bend = std::max(1 / curvature_of(at), out);
        const double inwards = out * (at[5] * p.cosine + at[6] * p.sine) / size;
        const double across = std::hypot(beyond * reach_, bend - inwards) - bend;
        return unbent + out - std::sqrt(across * across + std::max(out * out - inwards * inwards, 0.0));
    }

    // An elbow leaves the cylinder by many thresholds soon, so a bend is also fitted to what lies next to its
    // beginning, whatever its distance, and in each round to points twice as far along it.
    PipeFit fitted(int numbers, double start) const
    {
        const PipeFit of_near = settled(numbers, start, pipe_.threshold, infinity);
        return numbers == straight ? of_near
                                   : std::min(of_near, settled(numbers, start, infinity, first_bent), is_better);
    }

    // `first`: maximum distance in the first round. `beyond`: how far beyond its beginning the bend is then followed.
    PipeFit settled(int numbers, double start, double first, double beyond) const
    {
        PipeFit fit;
        fit.start = start;
        for (int round = 0; round < rounds; ++round, beyond *= 2) {
            Products products = Products::Zero();
            Numbers pulls = Numbers::Zero();
            for (const PipePoint& p : points_) {
                const double left = p.distance - predicted(fit.numbers, numbers, start, p);
                if (std::fabs(left) > (round == 0 ? first : most_) || p.way - start > beyond) continue;
                const Numbers by = row(fit.numbers, numbers, start, p);
                products += by * by.transpose();
                pulls += left * by;
            }
            products.diagonal().array() += 1e-9 * products.trace();
            fit.numbers += products.ldlt().solve(pulls);
        }
        double sum = 0;
        for (const PipePoint& p : points_) {
            const double left = p.distance - predicted(fit.numbers, numbers, start, p);
            sum += std::min(left * left, most_ * most_);
        }
        fit.misfit = sum / (2 * pipe_.noise * pipe_.noise);
        return fit;
    }

    const PipeAtPlace& pipe_;
    const double reach_, most_;
    std::vector<PipePoint> points_;
};

// The first start of a bend of at most this misfit, between that of a pipe and the one before it. Infinite if there is
// none.
double least_start(const std::vector<PipeFit>& pipes, double most)
{
    for (std::size_t k = 0; k < pipes.size(); ++k) {
        if (!(pipes[k].misfit <= most)) continue;
        if (k == 0) return -infinity;
        const double share = (most - pipes[k].misfit) / (pipes[k - 1].misfit - pipes[k].misfit);
        return pipes[k].start - share * (pipes[k].start - pipes[k - 1].start);
    }
    return infinity;
}

}  // namespace

double reach_of_bends(const PipeAtPlace& pipe)
{
    return 2 * std::sqrt(2 * wide_bend * pipe.cylinder.radius * around_thresholds * pipe.threshold);
}

std::optional<NearBend> bend_near(const PipeAtPlace& pipe, const std::vector<Vec3d>& points)
{
    const std::array<BendSearch, 2> ways{BendSearch(pipe, points, 1), BendSearch(pipe, points, -1)};
    const std::array<std::vector<PipeFit>, 2> pipes{ways[0].bent_pipes(), ways[1].bent_pipes()};
    if (pipes[0].empty()) return {};
    const std::array<PipeFit, 2> least{*std::min_element(pipes[0].begin(), pipes[0].end(), is_better),
                                       *std::min_element(pipes[1].begin(), pipes[1].end(), is_better)};
    const std::size_t way = is_better(least[1], least[0]) ? 1 : 0;
    const PipeFit& best = least[way];
    const double curvature = ways[way].curvature_of(best.numbers), shared = ways[way].shared(best);
    if (!(curvature > 0 && curvature * pipe.cylinder.radius < 1)) return {};
    NearBend found;
    found.evidence = (ways[way].straight_pipe().misfit - best.misfit) / shared;
    if (!(found.evidence > place_tuning().kinds.min_evidence)) return {};
    found.start = best.start * ways[way].reach();
    found.radius = 1 / curvature;
    found.direction = (way == 0 ? 1.0 : -1.0) * pipe.cylinder.axis;
    const double most = best.misfit + interval * interval / 2 * shared;
    found.least_start = std::min(least_start(pipes[0], most), least_start(pipes[1], most)) * ways[way].reach();
    return found;
}

std::optional<Vec3d> place_on(const NearBend& bend, const Vec3d& place, const std::vector<Vec3d>& points)
{
    const auto way = [&](const Vec3d& p) { return dot(p - place, bend.direction); };
    std::vector<Vec3d> bent;
    for (const Vec3d& p : points)
        if (way(p) > std::max(bend.start, 0.0)) bent.push_back(p);
    if (bent.empty()) return {};
    const auto far = bent.begin() + static_cast<std::ptrdiff_t>(bent.size() * 9 / 10);
    std::nth_element(bent.begin(), far, bent.end(), [&](const Vec3d& a, const Vec3d& b) { return way(a) < way(b); });
    return *far;
}

}  // namespace pcm
