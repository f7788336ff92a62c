#include "pcm/fit/shape_sums.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/least_squares.h"

#include <cmath>

namespace pcm {

ShapeSums::ShapeSums(const Shape& shape, const Vec3d& middle, double extent)
    : shape_(shape), middle_(middle), extent_(extent > 0 && std::isfinite(extent) ? extent : 1)
{
    check(shape);
    patch_ = model_of(shape.kind).patch_at(scaled(shape, middle_, extent_), {});
    sums_.parameters = model_of(shape.kind).parameters();
}

void ShapeSums::add(const Vec3d& p)
{
    const Vec3d place = (p - middle_) / extent_;
    PatchBlock block;
    model_of(shape_.kind).differentiate(patch_, &place[0], &place[1], &place[2], 1, block);
    add_to(sums_, block, 0);
}

void ShapeSums::add(const ShapeSums& other) { add_to(sums_, other.sums_); }

void ShapeSums::subtract(const ShapeSums& other) { take_from(sums_, other.sums_); }

double ShapeSums::rms() const { return sums_.used > 0 ? std::sqrt(sums_.squares / sums_.used) * extent_ : 0; }

std::optional<Shape> ShapeSums::step(double part) const
{
    const ShapeModel& model = model_of(shape_.kind);
    std::array<double, most_parameters> step{};
    if (sums_.inliers < model.parameters() || !step_of(model, sums_, 1, 0, step)) return {};
    for (double& by : step) by *= part;
    const Shape moved = model.shape_of(model.moved(patch_, step.data()));
    if (!is_proper(moved)) return {};
    return unscaled(moved, middle_, extent_);
}

ShapeFit ShapeSums::result(double threshold) const
{
    // What the cut at the threshold takes away.
    const double cut = threshold > 0 ? threshold / extent_ : infinity;
    const double noise = deviation_of_cut(rms() / extent_, cut);
    PatchSums sums = sums_;
    sums.slope -= density_at_cut(noise, cut, static_cast<double>(sums.inliers));
    ShapeFit fit = judged(model_of(shape_.kind), patch_, sums, noise, {}, 1);
    fit.shape = shape_;
    to_source_units(fit, extent_);
    fit.threshold = threshold;
    return fit;
}

}  // namespace pcm
