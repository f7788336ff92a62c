#include "pcm/fit/least_squares.h"

#include "pcm/cloud/numbers.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_parameters, 1>;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_parameters, most_parameters>;

}  // namespace

bool step_of(const ShapeModel& model, const PatchSums& sums, double extent, double damping,
             std::array<double, most_parameters>& step)
{
    const auto p = static_cast<Eigen::Index>(model.parameters());
    Matrix a = Matrix::Zero(p, p);
    Vector g = Vector::Zero(p);
    const auto scale = parameter_units(model, extent);
    for (std::size_t j = 0; j < model.parameters(); ++j) {
        const auto row = static_cast<Eigen::Index>(j);
        g[row] = sums.gradient[j] * scale[j];
        for (std::size_t k = j; k < model.parameters(); ++k) {
            const auto column = static_cast<Eigen::Index>(k);
            a(row, column) = a(column, row) = sums.products[j * most_parameters + k] * scale[j] * scale[k];
        }
    }
    const double least = 1e-14 * a.diagonal().maxCoeff();
    if (!(least > 0) || !a.allFinite()) return false;
    for (Eigen::Index j = 0; j < p; ++j) a(j, j) += damping * a(j, j) + least;
    const Vector x = a.ldlt().solve(-g);
    if (!x.allFinite()) return false;
    for (std::size_t j = 0; j < model.parameters(); ++j) step[j] = x[static_cast<Eigen::Index>(j)] * scale[j];
    return true;
}

namespace {

// How much a step lowers the sum of squares, as the equations see it.
double gain_of(const PatchSums& sums, const std::array<double, most_parameters>& step)
{
    double gain = 0;
    for (std::size_t j = 0; j < sums.parameters; ++j) gain -= sums.gradient[j] * step[j];
    return gain;
}

double size_of(const std::array<double, most_parameters>& step)
{
    double size = 0;
    for (const double by : step) size = std::max(size, std::fabs(by));
    return size;
}

// The mixture is known well enough after this number of steps.
constexpr unsigned most_learned = 8;

double mean_square(const PatchSums& sums) { return sums.used > 0 ? sums.squares / sums.used : 0; }

}  // namespace

double PolishedPatch::noise() const
{
    const double rms = std::sqrt(mean_square(sums));
    // Bins do not show noise that is far below the threshold, and weights do not change its rms.
    return mixture.deviation() > 0.05 * mixture.threshold() ? mixture.deviation() : rms;
}

namespace {

PolishedPatch descended(const ShapeModel& model, const SurfacePatch& start, const WorkingPoints& points,
                        const PatchBand& band, unsigned most_steps, double enough, bool weighted)
{
    constexpr double extent = 1;  // working units
    PolishedPatch best{start, {}, NoiseMixture(band.threshold, band.share, band.deviation), false};
    DistanceBins bins;
    const NoiseMixture* mixture = weighted ? &best.mixture : nullptr;
    best.sums = sums_of(model, start, points, band, mixture, weighted ? &bins : nullptr);
    double damping = 0, gain_before = 0;
    unsigned learned = 0;
    for (unsigned done = 0; done < most_steps; ++done) {
        if (weighted && learned < most_learned && damping == 0 && std::isfinite(band.threshold)) {
            ++learned;
            if (best.mixture.learn(bins, std::sqrt(mean_square(best.sums))))
                best.sums = sums_of(model, best.patch, points, band, mixture);
        }
        std::array<double, most_parameters> step{};
        if (best.sums.inliers < model.parameters() || !step_of(model, best.sums, extent, damping, step)) return best;
        const double gain = gain_of(best.sums, step);
        // Weights fall with the distance, so that a step of full length goes about that much too short.
        if (weighted && damping == 0)
            for (double& by : step) by *= std::clamp(best.sums.used / best.sums.slope, 1.0, 2.0);
        const SurfacePatch next = model.moved(best.patch, step.data());
        DistanceBins next_bins;
        const PatchSums sums = sums_of(model, next, points, band, mixture, weighted ? &next_bins : nullptr);
        const double square = mean_square(best.sums);
        // What is left to gain after this step, where steps shrink as from the one before to it.
        const double left = damping == 0 && gain < gain_before ? gain * (gain / gain_before) : gain;
        const bool ended = gain <= enough * square || size_of(step) < 1e-13;
        if (is_proper(model.shape_of(next)) && sums.cost <= best.sums.cost * (1 + 1e-12) + 1e-6 * square) {
            best.patch = next;
            best.sums = sums;
            best.converged = (ended || left <= enough * square) && damping <= 1e-6;
            bins = next_bins;
            if (best.converged) return best;
            gain_before = damping == 0 ? gain : 0;
            damping = damping > 1e-6 ? damping / 10 : 0;
        } else {
            best.converged = ended || damping > 1e8;
            if (best.converged) return best;
            gain_before = 0;
            damping = std::max(1e-4, damping * 10);
        }
    }
    return best;
}

}  // namespace

PolishedPatch polish(const ShapeModel& model, const SurfacePatch& start, const WorkingPoints& points,
                     const PatchBand& band, unsigned most_steps, double enough)
{
    return descended(model, start, points, band, most_steps, enough, true);
}

SurfacePatch improved(const ShapeModel& model, const SurfacePatch& start, const WorkingPoints& points,
                      const PatchBand& band, unsigned most_steps, double enough)
{
    return descended(model, start, points, band, most_steps, enough, false).patch;
}

BandFacts band_facts(const ShapeModel& model, const PolishedPatch& polished, const WorkingPoints& points,
                     double threshold)
{
    const auto p = static_cast<Eigen::Index>(model.parameters());
    Matrix a = Matrix::Zero(p, p);
    for (Eigen::Index j = 0; j < p; ++j)
        for (Eigen::Index k = j; k < p; ++k)
            a(j, k) = a(k, j) =
                polished.sums.products[static_cast<std::size_t>(j) * most_parameters + static_cast<std::size_t>(k)];
    const Matrix inverse = a.ldlt().solve(Matrix::Identity(p, p));
    if (!inverse.allFinite()) return {1, infinity};
    return facts_of(model, polished.patch, points, threshold, inverse.data());
}

}  // namespace pcm
