#include "pcm/fit/station_sums.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/least_squares.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

using StationMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using StationVector = Eigen::VectorXd;

constexpr double most_condition = 1e15;

double square_root(double value) { return std::sqrt(std::max(0.0, value)); }

}  // namespace

// The sums of all stations in one, and how the shape answers them. In units of the shape's extent.
struct StationSums::Whole {
    StationMatrix inverse;   // A^-1, in units in which all parameters are lengths; empty: there is none
    StationVector unit;      // units of the parameters
    StationVector gradient;  // sum of J d, in these units
    StationMatrix across;    // p x 3S: G of all stations
    StationMatrix around;    // p x 3S: G by their turns
    StationVector pulls;     // 3S: sums of n d
    StationMatrix normals;   // 3S x 3S: Z^T Z
    double squares = 0, points = 0;
    std::vector<std::uint32_t> stations;

    bool is_good() const { return inverse.size() > 0; }
    StationMatrix h() const { return normals - across.transpose() * inverse * across; }
    StationVector u() const { return pulls - across.transpose() * inverse * gradient; }
    double squares_left() const { return squares - gradient.dot(inverse * gradient); }
};

StationSums::StationSums(const Shape& shape, const Vec3d& middle, double extent)
    : shape_(shape), middle_(middle), extent_(extent > 0 && std::isfinite(extent) ? extent : 1)
{
    check(shape);
    patch_ = model_of(shape.kind).patch_at(scaled(shape, middle_, extent_), {});
    // A patch may have its normals inwards.
    side_ = dot(patch_.normal(), normal_at(shape_, middle_ + extent_ * patch_.place)) < 0 ? -1 : 1;
}

StationSums::Seen StationSums::see(const Vec3d& p) const
{
    const ShapeModel& model = model_of(shape_.kind);
    const Vec3d place = (p - middle_) / extent_;
    PatchBlock block;
    model.differentiate(patch_, &place[0], &place[1], &place[2], 1, block);
    Seen seen;
    seen.distance = block.distance[0];
    for (std::size_t j = 0; j < model.parameters(); ++j) seen.by[j] = block.by[j][0];
    seen.normal = side_ * normal_at(shape_, p);
    seen.turned = cross(place, seen.normal);
    return seen;
}

void StationSums::add(const Vec3d& p, std::uint32_t station)
{
    const Seen seen = see(p);
    const std::size_t parameters = model_of(shape_.kind).parameters();
    OfStation& sums = stations_[station];
    ++sums.points;
    sums.squares += seen.distance * seen.distance;
    for (std::size_t j = 0; j < parameters; ++j) {
        sums.gradient[j] += seen.by[j] * seen.distance;
        for (std::size_t k = 0; k < parameters; ++k) sums.products[j * most_parameters + k] += seen.by[j] * seen.by[k];
        for (std::size_t a = 0; a < 3; ++a) {
            sums.across[3 * j + a] += seen.by[j] * seen.normal[a];
            sums.around[3 * j + a] += seen.by[j] * seen.turned[a];
        }
    }
    for (std::size_t a = 0; a < 3; ++a) {
        sums.pulls[a] += seen.normal[a] * seen.distance;
        for (std::size_t b = 0; b < 3; ++b) sums.normals[3 * a + b] += seen.normal[a] * seen.normal[b];
    }
}

void StationSums::add(const StationSums& other)
{
    for (const auto& [station, from] : other.stations_) {
        OfStation& to = stations_[station];
        to.points += from.points;
        to.squares += from.squares;
        for (std::size_t k = 0; k < to.gradient.size(); ++k) to.gradient[k] += from.gradient[k];
        for (std::size_t k = 0; k < to.products.size(); ++k) to.products[k] += from.products[k];
        for (std::size_t k = 0; k < to.across.size(); ++k) {
            to.across[k] += from.across[k];
            to.around[k] += from.around[k];
        }
        for (std::size_t k = 0; k < to.normals.size(); ++k) to.normals[k] += from.normals[k];
        to.pulls = to.pulls + from.pulls;
    }
}

std::uint64_t StationSums::points() const
{
    std::uint64_t points = 0;
    for (const auto& [station, sums] : stations_) points += sums.points;
    return points;
}

StationSums::Whole StationSums::whole() const
{
    const ShapeModel& model = model_of(shape_.kind);
    const auto p = static_cast<Eigen::Index>(model.parameters());
    const auto columns = 3 * static_cast<Eigen::Index>(stations_.size());
    Whole whole;
    const auto units = parameter_units(model, 1);
    whole.unit = Eigen::Map<const StationVector>(units.data(), p);
    whole.gradient = StationVector::Zero(p);
    whole.across = whole.around = StationMatrix::Zero(p, columns);
    whole.pulls = StationVector::Zero(columns);
    whole.normals = StationMatrix::Zero(columns, columns);
    StationMatrix products = StationMatrix::Zero(p, p);
    Eigen::Index at = 0;
    for (const auto& [station, sums] : stations_) {
        whole.stations.push_back(station);
        whole.squares += sums.squares;
        whole.points += static_cast<double>(sums.points);
        for (Eigen::Index j = 0; j < p; ++j) {
            const auto row = static_cast<std::size_t>(j);
            whole.gradient[j] += sums.gradient[row] * whole.unit[j];
            for (Eigen::Index k = 0; k < p; ++k)
                products(j, k) +=
                    sums.products[row * most_parameters + static_cast<std::size_t>(k)] * whole.unit[j] * whole.unit[k];
            for (Eigen::Index a = 0; a < 3; ++a) {
                const std::size_t column = 3 * row + static_cast<std::size_t>(a);
                whole.across(j, at + a) = sums.across[column] * whole.unit[j];
                whole.around(j, at + a) = sums.around[column] * whole.unit[j];
            }
        }
        for (Eigen::Index a = 0; a < 3; ++a) {
            whole.pulls[at + a] = sums.pulls[static_cast<std::size_t>(a)];
            for (Eigen::Index b = 0; b < 3; ++b)
                whole.normals(at + a, at + b) = sums.normals[static_cast<std::size_t>(3 * a + b)];
        }
        at += 3;
    }
    const Eigen::SelfAdjointEigenSolver<StationMatrix> system(products);
    const StationVector& values = system.eigenvalues();
    if (values[0] > 0 && values[p - 1] < most_condition * values[0])
        whole.inverse = system.eigenvectors() * values.cwiseInverse().asDiagonal() * system.eigenvectors().transpose();
    return whole;
}

bool StationSums::is_determined() const { return points() > model_of(shape_.kind).parameters() && whole().is_good(); }

double StationSums::noise_as_one() const
{
    const Whole all = whole();
    if (!all.is_good()) return 0;
    const double freedom = all.points - static_cast<double>(model_of(shape_.kind).parameters());
    return freedom > 0 ? square_root(all.squares_left() / freedom) * extent_ : 0;
}

double StationSums::noise_within() const
{
    const Whole all = whole();
    if (!all.is_good()) return 0;
    const StationMatrix h = all.h();
    const StationVector u = all.u();
    const Eigen::SelfAdjointEigenSolver<StationMatrix> system(h);
    const StationVector turned = system.eigenvectors().transpose() * u;
    const double most = system.eigenvalues()[turned.size() - 1];
    double explained = 0, freedom = all.points - static_cast<double>(model_of(shape_.kind).parameters());
    for (Eigen::Index k = 0; k < turned.size(); ++k)
        if (const double lambda = system.eigenvalues()[k]; lambda > 1e-9 * most && lambda > 1e-9) {
            explained += turned[k] * turned[k] / lambda;
            freedom -= 1;
        }
    return freedom > 0 ? square_root((all.squares_left() - explained) / freedom) * extent_ : noise_as_one();
}

StationEvidence StationSums::evidence(double noise) const
{
    StationEvidence evidence;
    if (stations_.size() < 2) return evidence;  // rounding leaves a little of its shift
    if (stations_.size() > StationEvidence::most_stations)
        return evidence;  // time and memory grow with its cube and square
    const Whole all = whole();
    if (!all.is_good() || !(noise > 0)) return evidence;
    const StationMatrix h = all.h();
    const StationVector u = all.u() * extent_;
    evidence.add(all.stations, {h.data(), h.data() + h.size()}, {u.data(), u.data() + u.size()}, noise);
    return evidence;
}

ShapeErrors StationSums::errors_of(const StationMoves& moves) const
{
    const Whole all = whole();
    ShapeFit fit;
    fit.shape = shape_;
    if (!all.is_good()) return fit.errors;
    const StationMatrix by_shifts = all.inverse * all.across * (moves.shift / extent_),
                        by_turns = all.inverse * all.around * moves.turn;
    StationMatrix covariance = by_shifts * by_shifts.transpose() + by_turns * by_turns.transpose();
    for (Eigen::Index j = 0; j < covariance.rows(); ++j)
        for (Eigen::Index k = 0; k < covariance.cols(); ++k) covariance(j, k) *= all.unit[j] * all.unit[k];
    fit.errors = errors_of_covariance(model_of(shape_.kind), patch_, covariance.data(), {}, 1);
    to_source_units(fit, extent_);
    return fit.errors;
}

ShiftedFit StationSums::shifted(double spread, double noise) const
{
    ShiftedFit fit;
    const Whole all = whole();
    if (!all.is_good()) return fit;
    const StationMatrix h = all.h();
    const double tau2 = std::pow(spread / extent_, 2), noise2 = std::pow(noise / extent_, 2);
    StationVector shifts = StationVector::Zero(h.rows());
    if (tau2 > 0) {
        StationMatrix system = tau2 * h;
        system.diagonal().array() += std::max(noise2, 1e-12 * tau2);
        shifts = tau2 * system.ldlt().solve(all.u());
    }
    const StationVector moved = all.inverse * (all.gradient - all.across * shifts);
    for (Eigen::Index j = 0; j < moved.size(); ++j) fit.moved[static_cast<std::size_t>(j)] = moved[j] * all.unit[j];
    for (std::size_t s = 0; s < all.stations.size(); ++s)
        for (std::size_t a = 0; a < 3; ++a)
            fit.shifts[all.stations[s]][a] = shifts[static_cast<Eigen::Index>(3 * s + a)] * extent_;
    return fit;
}

double StationSums::distance(const ShiftedFit& fit, const Vec3d& p, std::uint32_t station) const
{
    const Seen seen = see(p);
    double distance = seen.distance;
    for (std::size_t j = 0; j < model_of(shape_.kind).parameters(); ++j) distance -= seen.by[j] * fit.moved[j];
    const auto shift = fit.shifts.find(station);
    return distance * extent_ - (shift == fit.shifts.end() ? 0 : dot(seen.normal, shift->second));
}

}  // namespace pcm
