#include "pcm/place/one_surface.h"

#include "pcm/fit/near_tree.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/axis_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace pcm {
namespace {

constexpr std::size_t most_places = 200;

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

// Squared slope of the plane through distances over places along the shape, and its mean for noise alone.
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
    const EvidenceTuning& tuned = place_tuning().evidence;
    return points >= tuned.neighbours && !has_shared_errors() &&
           two_peaks > tuned.max_two_peaks + tuned.two_peaks_by_chance / std::sqrt(static_cast<double>(points));
}

bool SurfaceEvidence::has_shared_errors() const { return bend > place_tuning().evidence.shared_bend; }

bool SurfaceEvidence::is_turned() const
{
    const EvidenceTuning& tuned = place_tuning().evidence;
    return (bend > tuned.min_turned_bend && slope > tuned.max_slope) ||
           (bend > tuned.min_own_bend && slope > tuned.max_own_slope && !has_shared_errors());
}

std::string SurfaceEvidence::reason() const
{
    if (has_two_peaks())
        return "the points leave the shape to both sides rather than about it, as those of several surfaces do";
    if (is_turned()) return "the surface of these points is turned away from the shape at most places";
    return {};
}

std::string SurfaceEvidence::message() const
{
    const std::string why = reason();
    if (why.empty()) return why;
    return why + ": pick a place farther from other surfaces, take a smaller neighbourhood, or give a threshold";
}

double spread_of(const ShapeFit& fit)
{
    return fit.noise > 0 ? std::min(fit.threshold, place_tuning().evidence.spread_noises * fit.noise) : fit.threshold;
}

double farthest_place(const ShapeFit& fit)
{
    const EvidenceTuning& tuned = place_tuning().evidence;
    return tuned.place_spreads * std::max(spread_of(fit), tuned.place_share * fit.threshold);
}

SurfaceEvidence surface_evidence(const Shape& shape, double threshold, double resolution,
                                 const std::vector<Vec3d>& points)
{
    SurfaceEvidence evidence;
    const std::size_t neighbours = place_tuning().evidence.neighbours;
    const Near near = near_shape(shape, threshold, points);
    const std::size_t count = evidence.points = near.distance.size();
    if (count < neighbours) return evidence;
    evidence.two_peaks =
        two_peaks_of(near.distance, std::max(resolution, place_tuning().evidence.min_spread * threshold));
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
        tree.nearest(near.foot[i], neighbours, around);
        double mean = 0;
        for (const NearTree::Near& one : around) mean += near.distance[one.index] / static_cast<double>(neighbours);
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
