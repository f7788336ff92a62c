// What is known of a result: errors, and whether to trust it.
#include "pcm/fit/least_squares.h"
#include "pcm/fit/tuning.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_parameters, most_parameters>;

// The numbers that people read, whose errors are reported: place, axis, radius, second.
struct Numbers {
    Vec3d place{}, axis{};
    double radius = 0, second = 0;
};

Numbers numbers_of(const Shape& shape, const Vec3d& middle)
{
    return {traits_of(shape.kind).place_near(shape, middle), shape.axis, shape.radius, shape.second};
}

// Maximum standard deviation in any direction.
double largest(const Eigen::Matrix3d& covariance)
{
    return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()[2]));
}

ShapeErrors errors_of(const ShapeModel& model, const SurfacePatch& patch, const Matrix& covariance, const Vec3d& middle,
                      const double* unit)
{
    const auto p = static_cast<Eigen::Index>(model.parameters());
    Eigen::Matrix<double, 8, Eigen::Dynamic> by(8, p);
    for (Eigen::Index j = 0; j < p; ++j) {
        std::array<double, most_parameters> step{};
        const auto at = static_cast<std::size_t>(j);
        const double small = model.dimension[at] < 0 ? 1e-6 * std::fabs(patch.curvature) : 1e-6 * unit[at];
        const auto numbers = [&](double by_step) {
            step[at] = by_step;
            return numbers_of(model.shape_of(model.moved(patch, step.data())), middle);
        };
        const Numbers low = numbers(-small), high = numbers(small);
        const Vec3d place = high.place - low.place, axis = high.axis - low.axis;
        by.col(j) << place[0], place[1], place[2], axis[0], axis[1], axis[2], high.radius - low.radius,
            high.second - low.second;
        by.col(j) /= 2 * small;
    }
    const Eigen::Matrix<double, 8, 8> all = by * covariance * by.transpose();
    ShapeErrors errors;
    const ShapeTraits& row = model.traits;
    errors.position = largest(all.block<3, 3>(0, 0));
    if (row.has_axis()) errors.angle = largest(all.block<3, 3>(3, 3));
    for (const ShapeSize& size : row.sizes) {
        const int at = size.value == &Shape::radius ? 6 : 7;
        errors.*size.error = std::sqrt(std::max(0.0, all(at, at)));
    }
    return errors;
}

void grow(double& error, double other)
{
    if (other > fit_tuning().judgement.error_factor * error) error = other;
}

void grow(ShapeErrors& errors, const ShapeErrors& other)
{
    grow(errors.position, other.position);
    grow(errors.angle, other.angle);
    grow(errors.radius, other.radius);
    grow(errors.second, other.second);
}

void doubt(ShapeFit& fit, FitVerdict verdict, FitIssue issue, const std::string& message)
{
    fit.verdict = verdict;
    fit.issue = issue;
    fit.message = message;
}

void judge_size(const Shape& shape, double used, ShapeFit& fit)
{
    const auto [flat, other] = model_of(shape.kind).significance(shape, fit.errors);
    const JudgementTuning& tuned = fit_tuning().judgement;
    if (!(flat >= tuned.min_significance)) {
        fit.errors.radius = traits_of(shape.kind).has_radius() ? infinity : 0;
        fit.errors.position = infinity;
        doubt(fit, FitVerdict::refused, FitIssue::coplanar,
              "the points are a plane within their noise: fit a plane, or take points farther around the shape");
    } else if (!(std::min(flat, other) >= tuned.good_significance) || !(flat >= tuned.min_bend * std::sqrt(used))) {
        doubt(fit, FitVerdict::doubtful, FitIssue::thin_arc,
              "the points cover too little of the shape for their noise, so its size is uncertain: take points "
              "farther around it");
        // To the flatter side, which is the farther one.
        const double wider = 1 + 1 / (flat - 1);  // finite for an infinite one
        fit.errors.radius *= wider;
        fit.errors.position *= wider;
    }
}

}  // namespace

ShapeFit judged(const ShapeModel& model, const SurfacePatch& patch, const PatchSums& sums, double noise,
                const Vec3d& middle, double extent, const double* scatter)
{
    ShapeFit fit;
    const auto p = static_cast<Eigen::Index>(model.parameters());
    fit.inliers = sums.inliers;
    fit.rms = sums.used > 0 ? std::sqrt(sums.squares / sums.used) : 0;
    if (sums.inliers < model.parameters()) {
        doubt(fit, FitVerdict::refused, FitIssue::too_few_points,
              "fewer points than determine the shape are within the threshold");
        return fit;
    }
    const double freedom = sums.used / std::max(1.0, sums.used - static_cast<double>(model.parameters()));
    fit.noise = noise * std::sqrt(freedom);
    Matrix a = Matrix::Zero(p, p);
    const auto unit = parameter_units(model, extent);
    for (std::size_t j = 0; j < model.parameters(); ++j)
        for (std::size_t k = j; k < model.parameters(); ++k) {
            const auto row = static_cast<Eigen::Index>(j), column = static_cast<Eigen::Index>(k);
            a(row, column) = a(column, row) = sums.products[j * most_parameters + k] * unit[j] * unit[k];
        }
    const Eigen::SelfAdjointEigenSolver<Matrix> system(a);
    const double least = system.eigenvalues()[0], most = system.eigenvalues()[p - 1];
    fit.condition = least > 0 ? most / least : infinity;
    if (!(fit.condition < 1e15)) {
        fit.condition = infinity;
        fit.errors = {infinity, model.traits.has_axis() ? infinity : 0, 0, 0};
        for (const ShapeSize& size : model.traits.sizes) fit.errors.*size.error = infinity;
        doubt(fit, FitVerdict::doubtful, FitIssue::thin_arc,
              "the points cover too little of the shape to determine it: take points farther around it");
        return fit;
    }
    // Covariance of a weighted estimate (Huber 1981): the equations' own weights, and the loss at the cut.
    const double slope = std::max(sums.slope, 0.05 * sums.used);
    const double square = sums.pull * freedom * sums.used / (slope * slope);
    Matrix covariance = system.eigenvectors() * system.eigenvalues().cwiseInverse().asDiagonal() *
                        system.eigenvectors().transpose() * square;
    for (Eigen::Index j = 0; j < p; ++j)
        for (Eigen::Index k = 0; k < p; ++k)
            covariance(j, k) *= unit[static_cast<std::size_t>(j)] * unit[static_cast<std::size_t>(k)];
    fit.errors = errors_of(model, patch, covariance, middle, unit.data());
    if (scatter) {
        Matrix b(p, p);
        for (Eigen::Index j = 0; j < p; ++j)
            for (Eigen::Index k = 0; k < p; ++k)
                b(j, k) = scatter[static_cast<std::size_t>(j) * most_parameters + static_cast<std::size_t>(k)];
        // Both in the parameters' own units; `covariance` is the inverse of their products, scaled.
        const Matrix pulled =
            covariance * b * covariance * (sums.used / (slope * square) * (sums.used / (slope * square)));
        grow(fit.errors, errors_of(model, patch, pulled, middle, unit.data()));
    }
    fit.verdict = FitVerdict::good;
    judge_size(model.shape_of(patch), sums.used, fit);
    return fit;
}

ShapeErrors errors_of_covariance(const ShapeModel& model, const SurfacePatch& patch, const double* covariance,
                                 const Vec3d& middle, double extent)
{
    const auto p = static_cast<Eigen::Index>(model.parameters());
    const Matrix matrix =
        Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(covariance, p, p);
    return errors_of(model, patch, matrix, middle, parameter_units(model, extent).data());
}

bool is_nearly_flat(const ShapeFit& fit, const Shape& shape, const PatchSums& sums)
{
    const auto [flat, other] = model_of(shape.kind).significance(shape, fit.errors);
    return fit.has_shape() && std::min(flat, other) < fit_tuning().judgement.flat_curvature * std::sqrt(sums.used);
}

void to_source_units(ShapeFit& fit, double unit)
{
    fit.errors.position *= unit;
    for (const ShapeSize& size : traits_of(fit.shape.kind).sizes)
        if (size.unit == SizeUnit::length) fit.errors.*size.error *= unit;
    fit.threshold *= unit;
    fit.noise *= unit;
    fit.rms *= unit;
}

}  // namespace pcm
