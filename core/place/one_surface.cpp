#include "pcm/place/one_surface.h"

#include "pcm/fit/near_tree.h"
#include "pcm/shapes/axis_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace pcm {
namespace {

constexpr std::size_t judged_neighbours = 17;  // the point itself among them, as in surface_beyond.cpp
constexpr std::size_t most_places = 200;
constexpr double threshold_noises = 3.3;

// From 180 clicks on plants that were ray-cast from stations, shapes among clutter, canopies, and on the scans of
// GROUND_TRUTH.csv. Fits to one surface have 0.29 to 0.42 of two_peaks where there are 500 points (table by stereo:
// 0.40), and up to 0.48 of 60 points; plates, racks and posts 0.47 to 0.87 of 500 points and more. The root of the
// number of points is how chance spreads it: by 0.54 / root(n) for Gaussian noise.
constexpr double most_two_peaks = 0.45, by_chance = 0.5;
// In the same clicks: a mug by stereo, whose errors neighbours share, has a bend of 0.58 to 0.79 with a slope of 0.39
// at most, and of 0.84 to 0.87 with 0.58 where all of it was reached; canopies called planes or spheres have slopes of
// 0.83 to 1.33. Plates, racks and posts have bends up to 0.39, the whole mug 0.47 to 0.53 of two_peaks.
constexpr double least_spread = 0.03;  // of the threshold: coordinates that are exact up to their rounding
constexpr double least_bend = 0.3, most_slope = 0.7, shared_bend = 0.6;

struct Near {
    std::vector<Vec3d> foot;  // on the shape, about the first of the points
    std::vector<Vec3d> normal;
    std::vector<double> distance;
};

Near near_shape(const Shape& shape, double threshold, const std::vector<Vec3d>& points)
{
    Near near;
    for (const Vec3d& p : points) {
        const double d = signed_distance(shape, p);
        if (!(std::fabs(d) <= threshold)) continue;
        const Vec3d normal = normal_at(shape, p);
        near.foot.push_back(p - points.front() - d * normal);
        near.normal.push_back(normal);
        near.distance.push_back(d);
    }
    return near;
}

double two_peaks_of(const std::vector<double>& distances, double resolution)
{
    const auto n = static_cast<double>(distances.size());
    double mean = 0, second = 0, third = 0, fourth = 0;
    for (const double d : distances) mean += d / n;
    for (const double d : distances) {
        const double square = (d - mean) * (d - mean);
        second += square / n;
        third += square * (d - mean) / n;
        fourth += square * square / n;
    }
    if (!(second > resolution * resolution)) return 0;
    // (third^2 / second^3 + 1) / (fourth / second^2)
    return fourth > 0 ? (third * third / second + second * second) / fourth : 0;
}

// Of the plane through distances over places along the shape: squared slope, and what noise makes of it on average.
struct Tilt {
    double square = 0, of_noise = 0;
};

std::optional<Tilt> tilt_of(const Near& near, std::size_t place, const std::vector<NearTree::Near>& around)
{
    const AxisFrame frame(near.normal[place]);
    const auto n = static_cast<double>(around.size());
    std::array<double, 2> middle{};
    double mean = 0;
    const auto at = [&](const NearTree::Near& one) {
        const Vec3d d = near.foot[one.index] - near.foot[place];
        return std::array<double, 2>{dot(d, frame.u), dot(d, frame.v)};
    };
    for (const NearTree::Near& one : around) {
        const auto [u, v] = at(one);
        middle[0] += u / n;
        middle[1] += v / n;
        mean += near.distance[one.index] / n;
    }
    double uu = 0, uv = 0, vv = 0, ud = 0, vd = 0, dd = 0;
    for (const NearTree::Near& one : around) {
        const auto [x, y] = at(one);
        const double u = x - middle[0], v = y - middle[1], d = near.distance[one.index] - mean;
        uu += u * u, uv += u * v, vv += v * v, ud += u * d, vd += v * d, dd += d * d;
    }
    const double area = uu * vv - uv * uv;
    if (!(area > 1e-4 * (uu + vv) * (uu + vv))) return {};  // on a line
    const double a = (ud * vv - vd * uv) / area, b = (vd * uu - ud * uv) / area;
    const double left = std::max(0.0, dd - a * ud - b * vd) / (n - 3);
    return Tilt{a * a + b * b, left * (uu + vv) / area};
}

}  // namespace

bool SurfaceEvidence::has_two_peaks() const
{
    return points >= judged_neighbours && !has_shared_errors() &&
           two_peaks > most_two_peaks + by_chance / std::sqrt(static_cast<double>(points));
}

bool SurfaceEvidence::has_shared_errors() const { return bend > shared_bend; }

bool SurfaceEvidence::is_turned() const { return bend > least_bend && slope > most_slope; }

std::string SurfaceEvidence::message() const
{
    const std::string hint =
        ": pick a place farther from other surfaces, take a smaller neighbourhood, or give a "
        "threshold";
    if (has_two_peaks())
        return "the points leave the shape to both sides rather than about it, as those of several surfaces do" + hint;
    if (is_turned()) return "the surface of these points is turned away from the shape at most places" + hint;
    return {};
}

double spread_of(const ShapeFit& fit)
{
    return fit.noise > 0 ? std::min(fit.threshold, threshold_noises * fit.noise) : fit.threshold;
}

double farthest_place(const ShapeFit& fit)
{
    constexpr double beyond = 1.2, part = 0.3;
    return beyond * std::max(spread_of(fit), part * fit.threshold);
}

SurfaceEvidence surface_evidence(const Shape& shape, double threshold, double resolution,
                                 const std::vector<Vec3d>& points)
{
    SurfaceEvidence evidence;
    const Near near = near_shape(shape, threshold, points);
    const std::size_t count = evidence.points = near.distance.size();
    if (count < judged_neighbours) return evidence;
    evidence.two_peaks = two_peaks_of(near.distance, std::max(resolution, least_spread * threshold));
    std::array<std::vector<double>, 3> foot;
    double squares = 0;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t a = 0; a < 3; ++a) foot[a].push_back(near.foot[i][a]);
        squares += near.distance[i] * near.distance[i] / static_cast<double>(count);
    }
    const NearTree tree(foot[0], foot[1], foot[2]);
    std::vector<NearTree::Near> around;
    double smooth = 0, tilted = 0, places = 0, planes = 0;
    for (std::size_t i = 0; i < count; i += 1 + count / most_places) {
        tree.nearest(near.foot[i], judged_neighbours, around);
        double mean = 0;
        for (const NearTree::Near& one : around) mean += near.distance[one.index] / judged_neighbours;
        smooth += mean * mean;
        places += 1;
        if (const auto tilt = tilt_of(near, i, around)) {
            tilted += tilt->square - tilt->of_noise;
            planes += 1;
        }
    }
    evidence.bend = squares > 0 ? smooth / places / squares : 0;
    evidence.slope = planes > 0 ? std::sqrt(std::max(0.0, tilted / planes)) : 0;
    return evidence;
}

}  // namespace pcm
