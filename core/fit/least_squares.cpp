#include "pcm/fit/least_squares.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_parameters, 1>;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_parameters, most_parameters>;

// Which points of a block take part: weights 1 or 0.
void weigh(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points, const PatchBand& band,
           std::size_t first, std::size_t count, const double* distance, double* weight)
{
    for (std::size_t i = 0; i < count; ++i) weight[i] = std::fabs(distance[i]) <= band.threshold ? 1 : 0;
    if (!(band.least_cosine > 0) || !points.has_normals()) return;
    const Shape shape = model.shape_of(patch);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d normal = points.normal(first + i);
        if (weight[i] > 0 && dot(normal, normal) > 0 &&
            std::fabs(dot(normal, normal_at(shape, points.at(first + i)))) < band.least_cosine)
            weight[i] = 0;
    }
}

}  // namespace

void add_to(PatchSums& sums, const PatchBlock& block, std::size_t i, double weight)
{
    const double d = block.distance[i];
    sums.used += weight;
    ++sums.inliers;
    sums.squares += weight * d * d;
    for (std::size_t j = 0; j < sums.parameters; ++j) {
        const double by = weight * block.by[j][i];
        sums.gradient[j] += by * d;
        for (std::size_t k = j; k < sums.parameters; ++k) sums.products[j * most_parameters + k] += by * block.by[k][i];
    }
}

void add_to(PatchSums& sums, const PatchSums& other)
{
    sums.used += other.used;
    sums.inliers += other.inliers;
    sums.squares += other.squares;
    sums.cost += other.cost;
    for (std::size_t j = 0; j < sums.gradient.size(); ++j) sums.gradient[j] += other.gradient[j];
    for (std::size_t j = 0; j < sums.products.size(); ++j) sums.products[j] += other.products[j];
}

PatchSums sums_of(const ShapeModel& model, const SurfacePatch& patch, const WorkingPoints& points,
                  const PatchBand& band)
{
    PatchSums sums;
    sums.parameters = model.parameters;
    const std::size_t n = std::min(points.size(), band.points);
    const double limit = band.threshold * band.threshold;
    PatchBlock block;
    double weight[patch_block];
    for (std::size_t first = 0; first < n; first += patch_block) {
        const std::size_t count = std::min(patch_block, n - first);
        model.differentiate(patch, &points.x[first], &points.y[first], &points.z[first], count, block);
        weigh(model, patch, points, band, first, count, block.distance, weight);
        for (std::size_t i = 0; i < count; ++i) {
            const double d = block.distance[i], square = d * d;
            sums.cost += weight[i] > 0 ? square : limit;
            if (!(weight[i] > 0)) continue;
            add_to(sums, block, i, weight[i]);
        }
    }
    return sums;
}

bool step_of(const ShapeModel& model, const PatchSums& sums, double extent, double damping,
             std::array<double, most_parameters>& step)
{
    const auto p = static_cast<Eigen::Index>(model.parameters);
    Matrix a = Matrix::Zero(p, p);
    Vector g = Vector::Zero(p), scale = Vector::Zero(p);
    for (Eigen::Index j = 0; j < p; ++j) scale[j] = std::pow(extent, model.dimension[static_cast<std::size_t>(j)] - 1);
    for (Eigen::Index j = 0; j < p; ++j) {
        g[j] = sums.gradient[static_cast<std::size_t>(j)] * scale[j];
        for (Eigen::Index k = j; k < p; ++k)
            a(j, k) = a(k, j) =
                sums.products[static_cast<std::size_t>(j) * most_parameters + static_cast<std::size_t>(k)] * scale[j] *
                scale[k];
    }
    const double least = 1e-14 * a.diagonal().maxCoeff();
    if (!(least > 0) || !a.allFinite()) return false;
    for (Eigen::Index j = 0; j < p; ++j) a(j, j) += damping * a(j, j) + least;
    const Vector x = a.ldlt().solve(-g);
    if (!x.allFinite()) return false;
    for (Eigen::Index j = 0; j < p; ++j) step[static_cast<std::size_t>(j)] = x[j] * scale[j];
    return true;
}

PolishedPatch polish(const ShapeModel& model, const SurfacePatch& start, const WorkingPoints& points,
                     const PatchBand& band, unsigned most_steps)
{
    constexpr double extent = 1;  // working units
    PolishedPatch best{start, sums_of(model, start, points, band), false};
    double damping = 0;
    for (unsigned done = 0; done < most_steps; ++done) {
        std::array<double, most_parameters> step{};
        if (best.sums.inliers < model.parameters || !step_of(model, best.sums, extent, damping, step)) return best;
        double size = 0;
        for (std::size_t j = 0; j < model.parameters; ++j) size = std::max(size, std::fabs(step[j]));
        const SurfacePatch next = model.moved(best.patch, step.data());
        const PatchSums sums = sums_of(model, next, points, band);
        if (is_proper(model.shape_of(next)) && sums.cost <= best.sums.cost * (1 + 1e-9)) {
            best.patch = next;
            best.converged = size < 1e-10 || (best.sums.inliers == sums.inliers &&
                                              std::fabs(best.sums.cost - sums.cost) <= 1e-12 * sums.cost);
            best.sums = sums;
            if (best.converged) return best;
            damping = damping > 1e-6 ? damping / 10 : 0;
        } else {
            if (size < 1e-12 || damping > 1e8) {
                best.converged = true;
                return best;
            }
            damping = std::max(1e-4, damping * 10);
        }
    }
    return best;
}

}  // namespace pcm
