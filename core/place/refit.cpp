#include "pcm/place/refit.h"

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/shape_sums.h"
#include "pcm/fit/tuning.h"
#include "pcm/place/error_agreement.h"
#include "pcm/place/tuning.h"
#include "pcm/select/point_scan.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

namespace pcm {
namespace {

constexpr double small_change = 0.01;  // in units of the errors: not worth another step

class Refit {
public:
    Refit(const PointSet& points, const RefitOptions& options)
        : points_(points), tree_(points.tree()), rounding_(tree_.info()), options_(options), watch_(options.progress)
    {
    }

    RefittedShape run(const Shape& start)
    {
        check(start);
        const Box3d box = box_of_points();
        middle_ = box.empty() ? start.point : box.centre();
        extent_ = box.diagonal();
        ShapeSums sums = sums_of(start);
        ShapeFit best = sums.result(options_.threshold);
        best.shape = start;
        double rms = sums.rms();
        bool improves = true;
        for (unsigned step = 0; step < options_.most_steps && improves; ++step) {
            improves = false;
            for (double part = 1; part > 0.1 && !improves; part /= 2) {
                const auto next = sums.step(part);
                if (!next || change_in_errors(best.shape, *next, best.errors, middle_) < small_change) break;
                ShapeSums there = sums_of(*next);
                if (!(there.rms() <= rms)) continue;
                improves = true;
                sums = there;
                rms = sums.rms();
                best = sums.result(options_.threshold);
                best.shape = *next;
            }
        }
        const double agreement = best.has_shape() ? agreement_of(best.shape, box) : 1;
        enlarge(best.errors, agreement);
        best.inliers = sums.points();
        best.threshold = options_.threshold;
        best.seconds = watch_.seconds();
        return {best, box, agreement};
    }

private:
    void scan(const std::function<void(const ScannedPoints&)>& take)
    {
        ScanOptions scan;
        scan.within = &points_;
        scan.columns = ColumnSet::only_positions();
        scan.select.threads = options_.threads;
        scan.select.progress = options_.progress;
        scan.stage = "Fitting to all points";
        // The number of passes is not known before.
        scan.begin = 1 - std::pow(0.7, passes_++);
        scan.end = 1 - std::pow(0.7, passes_);
        scan_points(tree_, {}, scan, take);
    }

    Vec3d position(const ScannedPoints& found, std::uint32_t i) const
    {
        return rounding_(tree_.info().grid.to_source(found.part.chunk.positions->grid(i)));
    }

    Box3d box_of_points()
    {
        Box3d box;
        std::mutex mutex;
        scan([&](const ScannedPoints& found) {
            Box3d part;
            for (const std::uint32_t i : found.indices) part.extend(position(found, i));
            const std::lock_guard lock(mutex);
            box.extend(part);
        });
        return box;
    }

    ShapeSums sums_of(const Shape& shape)
    {
        std::map<NodeId, ShapeSums> parts;
        std::mutex mutex;
        scan([&](const ScannedPoints& found) {
            ShapeSums part(shape, middle_, extent_);
            for (const std::uint32_t i : found.indices) part.add(position(found, i));
            const std::lock_guard lock(mutex);
            parts.emplace(found.node, part);
        });
        ShapeSums sums(shape, middle_, extent_);
        for (const auto& [node, part] : parts) sums.add(part);
        return sums;
    }

    double agreement_of(const Shape& shape, const Box3d& box)
    {
        const double edge = extent_ / place_tuning().growth.agreement_cubes;
        std::map<NodeId, ErrorAgreement> parts;
        std::mutex mutex;
        scan([&](const ScannedPoints& found) {
            ErrorAgreement part(box.min, edge);
            for (const std::uint32_t i : found.indices) {
                const Vec3d p = position(found, i);
                part.add(p, signed_distance(shape, p));
            }
            const std::lock_guard lock(mutex);
            parts.emplace(found.node, std::move(part));
        });
        ErrorAgreement all(box.min, edge);
        for (const auto& [node, part] : parts) all.add(part);
        return all.factor();
    }

    const PointSet& points_;
    const Tree& tree_;
    const SourceRounding rounding_;
    const RefitOptions& options_;
    Watch watch_;
    int passes_ = 0;
    Vec3d middle_{};
    double extent_ = 0;
};

double quotient(double change, double error)
{
    if (!(change > 0) || error == infinity) return 0;
    return change / error;
}

}  // namespace

ShapeErrors difference_of(const Shape& from, const Shape& to, const Vec3d& middle)
{
    const double side = dot(from.axis, to.axis) < 0 ? -1 : 1;  // a plane's normal has any sign
    const ShapeTraits& traits = traits_of(from.kind);
    ShapeErrors change;
    change.position = traits.is_flat()
                          ? std::fabs(signed_distance(from, middle) - side * signed_distance(to, middle))
                          : length(traits.place_near(from, middle) - traits_of(to.kind).place_near(to, middle));
    if (traits.has_axis()) change.angle = std::asin(std::min(1.0, length(cross(from.axis, to.axis))));
    for (const ShapeSize& size : traits.sizes) change.*size.error = std::fabs(from.*size.value - to.*size.value);
    return change;
}

namespace {

void doubt_edges(ShapeFit& fit)
{
    doubt(fit, FitIssue::thin_arc,
          "most of its points lie next to other surfaces, and the others leave its size uncertain: take points "
          "farther around it");
}

// `by`: what the number has changed by.
void contain(double by, double chance, double& error)
{
    if (by > chance) error = std::hypot(error, std::sqrt(by * by - chance * chance));
}

}  // namespace

bool is_size_certain(const ShapeFit& fit)
{
    const auto [flat, other] = model_of(fit.shape.kind).significance(fit.shape, fit.errors);
    return std::min(flat, other) >= fit_tuning().judgement.good_significance;
}

void contain_edges(const ShapeFit& inner, const Vec3d& middle, ShapeFit& fit)
{
    if (!inner.has_shape()) return doubt_edges(fit);
    const ShapeErrors moved = difference_of(fit.shape, inner.shape, middle);
    contain(moved.position, inner.errors.position, fit.errors.position);
    contain(moved.angle, inner.errors.angle, fit.errors.angle);
    contain(moved.radius, inner.errors.radius, fit.errors.radius);
    contain(moved.second, inner.errors.second, fit.errors.second);
    if (!is_size_certain(fit)) doubt_edges(fit);
}

void correct(const Shape& corrected, double uncertain, const Vec3d& middle, ShapeFit& fit)
{
    const ShapeErrors moved = difference_of(fit.shape, corrected, middle);
    fit.shape = corrected;
    fit.errors.position = std::hypot(fit.errors.position, uncertain * moved.position);
    fit.errors.angle = std::hypot(fit.errors.angle, uncertain * moved.angle);
    fit.errors.radius = std::hypot(fit.errors.radius, uncertain * moved.radius);
    fit.errors.second = std::hypot(fit.errors.second, uncertain * moved.second);
}

double change_in_errors(const Shape& from, const Shape& to, const ShapeErrors& errors, const Vec3d& middle)
{
    const ShapeErrors change = difference_of(from, to, middle);
    return std::max({quotient(change.position, errors.position), quotient(change.angle, errors.angle),
                     quotient(change.radius, errors.radius), quotient(change.second, errors.second)});
}

RefittedShape refit_shape(const PointSet& points, const Shape& start, const RefitOptions& options)
{
    return Refit(points, options).run(start);
}

}  // namespace pcm
