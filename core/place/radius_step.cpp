#include "pcm/place/radius_step.h"

#include "pcm/cloud/numbers.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/axis_frame.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace pcm {
namespace {

constexpr int circle_rounds = 6;

struct AlongPipe {
    double way = 0;
    std::array<double, 2> across{};
};

struct PipeSlice {
    double from = 0, to = 0;       // ways along the axis
    double radius = 0, error = 0;  // the error is infinite where the points determine no circle
};

using SlicePoint = std::vector<AlongPipe>::const_iterator;

// A circle by least squares of the distances, from that of the cylinder on.
PipeSlice slice_of(SlicePoint begin, SlicePoint end, double radius, double noise)
{
    PipeSlice slice{begin->way, (end - 1)->way, radius, infinity};
    std::array<double, 2> centre{};
    for (int round = 0; round < circle_rounds; ++round) {
        Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
        Eigen::Vector3d pull = Eigen::Vector3d::Zero();
        for (SlicePoint p = begin; p != end; ++p) {
            const double u = p->across[0] - centre[0], v = p->across[1] - centre[1], away = std::hypot(u, v);
            if (!(away > 0)) continue;
            const Eigen::Vector3d by(u / away, v / away, 1);
            products += by * by.transpose();
            pull += (away - slice.radius) * by;
        }
        const Eigen::LDLT<Eigen::Matrix3d> solver(products);
        const Eigen::Vector3d step = solver.solve(pull);
        const Eigen::Vector3d of_radius = solver.solve(Eigen::Vector3d(0, 0, 1));
        if (!step.allFinite() || !(of_radius[2] > 0)) return {slice.from, slice.to, radius, infinity};
        centre = {centre[0] + step[0], centre[1] + step[1]};
        slice.radius += step[2];
        slice.error = noise * std::sqrt(of_radius[2]);
    }
    if (!(slice.radius > 0) || !(slice.error < radius)) slice.error = infinity;
    return slice;
}

std::vector<PipeSlice> slices_of(const Shape& cylinder, double noise, const std::vector<Vec3d>& points)
{
    const RadiusStepTuning& tuned = place_tuning().radius_steps;
    const AxisFrame frame(cylinder.axis);
    std::vector<AlongPipe> along;
    for (const Vec3d& p : points) {
        const Vec3d d = p - cylinder.point;
        along.push_back({dot(d, cylinder.axis), {dot(d, frame.u), dot(d, frame.v)}});
    }
    std::sort(along.begin(), along.end(), [](const AlongPipe& a, const AlongPipe& b) {
        return std::pair(a.way, a.across) < std::pair(b.way, b.across);
    });
    std::vector<PipeSlice> slices;
    if (along.size() < tuned.slice_points) return slices;
    const double length = (along.back().way - along.front().way) / static_cast<double>(tuned.max_slices);
    for (auto begin = along.cbegin(), end = begin; begin != along.cend(); begin = end) {
        const auto few = static_cast<std::ptrdiff_t>(tuned.slice_points);
        while (end != along.cend() && (end - begin < few || end->way < begin->way + length)) ++end;
        if (along.cend() - end < few) end = along.cend();
        slices.push_back(slice_of(begin, end, cylinder.radius, noise));
    }
    return slices;
}

// Weighted sums of some slices' radii.
struct SliceSums {
    double weight = 0, first = 0, second = 0;

    void add(const PipeSlice& slice)
    {
        const double w = 1 / (slice.error * slice.error);
        weight += w;
        first += w * slice.radius;
        second += w * slice.radius * slice.radius;
    }
    double mean() const { return weight > 0 ? first / weight : 0; }
    double squares() const { return weight > 0 ? std::max(0.0, second - first * first / weight) : 0; }
};

}  // namespace

std::optional<RadiusStep> radius_step(const Shape& cylinder, double noise, double least, const Vec3d& place,
                                      const std::vector<Vec3d>& points)
{
    const RadiusStepTuning& tuned = place_tuning().radius_steps;
    if (!(noise > 0)) return {};
    const std::vector<PipeSlice> slices = slices_of(cylinder, noise, points);
    const double way = dot(place - cylinder.point, cylinder.axis);
    const auto own = static_cast<std::size_t>(
        std::find_if(slices.begin(), slices.end(), [&](const PipeSlice& slice) { return way <= slice.to; }) -
        slices.begin());
    if (own == slices.size()) return {};
    SliceSums all;
    for (const PipeSlice& slice : slices) all.add(slice);
    RadiusStep best;
    double most = 0;
    for (std::size_t begin = 0; begin <= own; ++begin)
        for (std::size_t end = own + 1; end <= slices.size(); ++end) {
            SliceSums inside, outside;
            for (std::size_t i = 0; i < slices.size(); ++i) (begin <= i && i < end ? inside : outside).add(slices[i]);
            const double explained = all.squares() - inside.squares() - outside.squares();
            if (!(outside.weight > 0 && inside.weight > 0 && explained > most)) continue;
            most = explained;
            best = {begin > 0 ? slices[begin].to : -infinity, end < slices.size() ? slices[end - 1].from : infinity,
                    inside.mean(), outside.mean()};
        }
    const bool is_step = std::fabs(best.beyond - best.radius) > least &&
                         most > tuned.min_significance * tuned.min_significance &&
                         most > tuned.min_share * all.squares();
    if (!is_step) return {};
    best.has_place = best.from < way && way < best.to;
    return best;
}

}  // namespace pcm
