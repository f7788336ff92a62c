#include "pcm/place/swept_part.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/axis_frame.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t most_slices = 48;
constexpr int most_rounds = 4;

double angle_from(double begin, double angle)
{
    const double a = std::fmod(angle - begin, 2 * pi);
    return a < 0 ? a + 2 * pi : a;
}

// The middle of the widest gap of angles, and its width.
std::array<double, 2> widest_gap(std::vector<double> angles)
{
    std::sort(angles.begin(), angles.end());
    std::array<double, 2> gap{angles.back(), 0};
    for (std::size_t i = 0; i < angles.size(); ++i) {
        const double next = i + 1 < angles.size() ? angles[i + 1] : angles.front() + 2 * pi;
        if (next - angles[i] > gap[1]) gap = {(angles[i] + next) / 2, next - angles[i]};
    }
    return gap;
}

// Where a point is along the sweep, and in which direction from its centre line.
struct OnSweep {
    double way = 0, u = 0, v = 0;
};

OnSweep on_sweep(const Shape& shape, double begin, const Vec3d& p)
{
    const AxisFrame frame(shape.axis);
    const Vec3d d = p - shape.point;
    const double h = dot(d, frame.axis), x = dot(d, frame.u), y = dot(d, frame.v);
    const double out = std::hypot(x, y) - shape.radius, q = std::max(std::hypot(out, h), 1e-300);
    return {angle_from(begin, std::atan2(y, x)), out / q, h / q};
}

// How far the sums of squares of a slice's points falls with a centre and radius of its own, per variance of the noise.
class Slice {
public:
    void add(const OnSweep& at, double distance)
    {
        const Eigen::Vector3d row(1, at.u, at.v);
        a_ += row * row.transpose();
        b_ += distance * row;
        ++points_;
    }
    void add(const Slice& other)
    {
        a_ += other.a_;
        b_ += other.b_;
        points_ += other.points_;
    }
    std::size_t points() const { return points_; }
    double gain(double variance) const
    {
        const Eigen::Matrix3d a = a_ + 1e-6 * static_cast<double>(points_) * Eigen::Matrix3d::Identity();
        return b_.dot(a.ldlt().solve(b_)) / variance;
    }

private:
    Eigen::Matrix3d a_ = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b_ = Eigen::Vector3d::Zero();
    std::size_t points_ = 0;
};

class SweepCut {
public:
    SweepCut(const Shape& shape, double noise, double threshold, const std::vector<Vec3d>& points)
        : threshold_(threshold), variance_(noise * noise), points_(points)
    {
        part_.shape = shape;
    }

    std::optional<SweptPart> run()
    {
        if (!set_ends()) return {};
        std::size_t first = 0, last = count_;
        double usual = 1;
        for (int round = 0; round < most_rounds; ++round) {
            slice_points();
            const auto [core_first, core_last] = best_half();
            const std::array<std::size_t, 2> before{first, last};
            usual = usual_gain(core_first, core_last);
            std::tie(first, last) = grown(core_first, core_last);
            set_range(first, last);
            if (round > 0 && before == std::array<std::size_t, 2>{first, last}) break;
            if (!fit_part()) return {};
        }
        if ((first == 0 && last == count_) || usual > tuned_.max_usual_gain) return {};
        leave_tangents();
        std::size_t own = 0;
        for (const Vec3d& p : points_) own += part_.has(p);
        if (static_cast<double>(own) < tuned_.min_swept * static_cast<double>(total_) || !fit_part()) return {};
        return part_;
    }

private:
    bool set_ends()
    {
        if (points_.size() < most_slices || !(variance_ > 0)) return false;
        std::vector<double> angles;
        for (const Vec3d& p : points_) angles.push_back(on_sweep(part_.shape, 0, p).way);
        const auto [middle, width] = widest_gap(std::move(angles));
        if (width < tuned_.min_swept_gap) return false;
        part_.begin = middle;
        std::vector<double> ways;
        for (const Vec3d& p : points_) ways.push_back(on_sweep(part_.shape, part_.begin, p).way);
        const auto [low, high] = std::minmax_element(ways.begin(), ways.end());
        low_ = *low;
        high_ = *high;
        const std::size_t enough = points_.size() / tuned_.min_slice_points;
        count_ = std::min(most_slices, enough);
        return count_ >= 8 && high_ > low_;
    }

    void slice_points()
    {
        slices_.assign(count_, {});
        for (const Vec3d& p : points_) {
            const OnSweep at = on_sweep(part_.shape, part_.begin, p);
            const double share = (at.way - low_) / (high_ - low_);
            if (!(share >= 0 && share <= 1)) continue;
            const auto k = std::min(count_ - 1, static_cast<std::size_t>(share * static_cast<double>(count_)));
            slices_[k].add(at, signed_distance(part_.shape, p));
        }
        total_ = points_of(0, count_);
    }

    std::size_t points_of(std::size_t first, std::size_t last) const
    {
        std::size_t points = 0;
        for (std::size_t k = first; k < last; ++k) points += slices_[k].points();
        return points;
    }

    double gain(std::size_t first, std::size_t last) const
    {
        double sum = 0;
        for (std::size_t k = first; k < last; ++k) sum += slices_[k].gain(variance_);
        return sum;
    }

    std::pair<std::size_t, std::size_t> best_half() const
    {
        const std::size_t width = count_ / 2;
        std::size_t best = 0;
        double least = infinity;
        for (std::size_t first = 0; first + width <= count_; ++first) {
            if (2 * points_of(first, first + width) < total_ / 2) continue;
            const double sum = gain(first, first + width);
            if (!(sum < least)) continue;
            least = sum;
            best = first;
        }
        return {best, best + width};
    }

    // Gain per degree of freedom: 1 where errors are independent.
    double usual_gain(std::size_t first, std::size_t last) const
    {
        return gain(first, last) / static_cast<double>(3 * (last - first));
    }

    // A slice and the next one together show what one alone does not.
    std::pair<std::size_t, std::size_t> grown(std::size_t first, std::size_t last) const
    {
        const double usual = std::max(1.0, usual_gain(first, last));
        const auto is_on = [&](std::size_t k, std::size_t next) {
            Slice both = slices_[k];
            if (next < count_) both.add(slices_[next]);
            const double limit = tuned_.max_slice_gain * usual;
            return slices_[k].gain(variance_) <= limit && both.gain(variance_) <= limit;
        };
        while (last < count_ && is_on(last, last + 1)) ++last;
        while (first > 0 && is_on(first - 1, first >= 2 ? first - 2 : count_)) --first;
        return {first, last};
    }

    void set_range(std::size_t first, std::size_t last)
    {
        const double width = (high_ - low_) / static_cast<double>(count_);
        part_.from = first == 0 ? -infinity : low_ + width * static_cast<double>(first);
        part_.to = last == count_ ? infinity : low_ + width * static_cast<double>(last);
    }

    // What slices do not show yet: next to a tangent the centre leaves the torus by s^2 / (2 R).
    void leave_tangents()
    {
        const double slice = 2 * static_cast<double>(total_) / static_cast<double>(count_);
        const double offset = std::sqrt(variance_ * tuned_.max_slice_gain * 3 / slice);
        const double angle = std::sqrt(2 * offset / part_.shape.radius);
        part_.from += angle;
        part_.to -= angle;
    }

    bool fit_part()
    {
        std::vector<Vec3d> own;
        for (const Vec3d& p : points_)
            if (part_.has(p)) own.push_back(p);
        RefineOptions options;
        options.threshold = threshold_;
        const ShapeFit fit = refine_shape(FitPoints::of(own), part_.shape, options);
        if (!fit.has_shape() || fit.shape.kind != part_.shape.kind) return false;
        const double side = dot(part_.shape.axis, fit.shape.axis) < 0 ? -1 : 1;  // keeps the direction of angles
        part_.shape = fit.shape;
        part_.shape.axis = side * fit.shape.axis;
        return true;
    }

    const GrowthTuning& tuned_ = place_tuning().growth;
    const double threshold_, variance_;
    const std::vector<Vec3d>& points_;
    SweptPart part_;
    std::vector<Slice> slices_;
    std::size_t count_ = 0, total_ = 0;
    double low_ = 0, high_ = 0;
};

}  // namespace

bool SweptPart::has(const Vec3d& p) const
{
    const double way = on_sweep(shape, begin, p).way;
    return way >= from && way < to;
}

std::optional<SweptPart> swept_part(const Shape& shape, double noise, double threshold,
                                    const std::vector<Vec3d>& points)
{
    if (shape.kind != ShapeKind::torus) return {};
    return SweepCut(shape, noise, threshold, points).run();
}

}  // namespace pcm
