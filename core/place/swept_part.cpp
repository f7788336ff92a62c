#include "pcm/place/swept_part.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/place/bent_tube.h"
#include "pcm/place/tuning.h"
#include "pcm/shapes/axis_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t most_swept = 2000;  // to find the ends

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

class SweepCut {
public:
    SweepCut(const Shape& shape, double threshold, const std::vector<Vec3d>& points, const std::vector<Vec3d>& around,
             const SweptPart* before)
        : threshold_(threshold), points_(points), around_(around), before_(before)
    {
        part_.shape = shape;
    }

    std::optional<SweptPart> run()
    {
        if (!set_ends()) return {};
        const std::vector<Vec3d> some = thinned();
        double squares = 0;
        for (const Vec3d& p : some) squares += std::pow(std::min(distance_to(part_.shape, p), threshold_), 2);
        const auto tube = fit_bent_tube(part_.shape, part_.start, first_ends(), some, threshold_);
        if (!tube || !(squares - tube->squares > tuned_.min_tangent_gain * tube->variance)) return {};
        part_.shape = tube->torus;
        const double from = tube->from + tuned_.end_errors * tube->from_error,
                     to = tube->to - tuned_.end_errors * tube->to_error;
        part_.from = from > low_ && from < high_ ? from : -infinity;
        part_.to = to < high_ && to > low_ ? to : infinity;
        std::size_t own = 0;
        for (const Vec3d& p : points_) own += part_.has(p);
        if (own == points_.size()) return {};
        if (static_cast<double>(own) < tuned_.min_swept * static_cast<double>(points_.size()) || !fit_part()) return {};
        return part_;
    }

private:
    bool set_ends()
    {
        if (points_.size() < tuned_.min_bent_points) return false;
        std::vector<double> angles;
        const AxisFrame frame(part_.shape.axis);
        for (const Vec3d& p : points_) angles.push_back(angle_about(part_.shape, frame.u, p));
        const auto [middle, width] = widest_gap(std::move(angles));
        if (width < tuned_.min_swept_gap) return false;
        part_.start = std::cos(middle) * frame.u + std::sin(middle) * cross(frame.axis, frame.u);
        if (before_) part_.start = before_->start;
        std::vector<double> ways;
        for (const Vec3d& p : points_) ways.push_back(angle_about(part_.shape, part_.start, p));
        const auto [low, high] = std::minmax_element(ways.begin(), ways.end());
        low_ = *low;
        high_ = *high;
        return high_ > low_;
    }

    // Those that were found before: beyond them may be another bend.
    std::vector<BendEnds> first_ends() const
    {
        std::vector<BendEnds> ends = ends_between(low_, high_);
        for (BendEnds& one : ends) {
            if (before_ && std::isfinite(before_->from)) one.from = before_->from;
            if (before_ && std::isfinite(before_->to)) one.to = before_->to;
        }
        const auto is_same = [](const BendEnds& a, const BendEnds& b) { return a.from == b.from && a.to == b.to; };
        std::sort(ends.begin(), ends.end(), [](const BendEnds& a, const BendEnds& b) {
            return std::make_pair(a.from, a.to) < std::make_pair(b.from, b.to);
        });
        ends.erase(std::unique(ends.begin(), ends.end(), is_same), ends.end());
        return ends;
    }

    std::vector<Vec3d> thinned() const
    {
        std::vector<Vec3d> some;
        for (std::size_t i = 0; i < around_.size(); i += 1 + around_.size() / most_swept) some.push_back(around_[i]);
        return some;
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
    const double threshold_;
    const std::vector<Vec3d>&points_, &around_;
    const SweptPart* const before_;
    SweptPart part_;
    double low_ = 0, high_ = 0;  // first and last angle of the points
};

}  // namespace

bool SweptPart::has(const Vec3d& p) const
{
    const double way = angle_about(shape, start, p);
    return way >= from && way < to;
}

std::optional<SweptPart> swept_part(const Shape& shape, double threshold, const std::vector<Vec3d>& points,
                                    const std::vector<Vec3d>& around, const SweptPart* before)
{
    if (shape.kind != ShapeKind::torus) return {};
    return SweepCut(shape, threshold, points, around, before).run();
}

}  // namespace pcm
