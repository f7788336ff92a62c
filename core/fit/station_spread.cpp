#include "pcm/fit/station_spread.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

using SpreadMatrix = Eigen::MatrixXd;
using SpreadVector = Eigen::VectorXd;

// An observation of the spread: its square has the mean tau^2 + variance.
struct Difference {
    double square = 0, variance = 0;
};

// Twice the negative logarithm of the likelihood of tau^2, but for a constant.
double cost_of(const std::vector<Difference>& differences, double tau2)
{
    double cost = 0;
    for (const Difference& d : differences) cost += std::log(tau2 + d.variance) + d.square / (tau2 + d.variance);
    return cost;
}

double most_probable(const std::vector<Difference>& differences)
{
    double largest = 0, least = 0;
    for (const Difference& d : differences) {
        largest = std::max(largest, d.square);
        least = least > 0 ? std::min(least, d.variance) : d.variance;
    }
    double best = 0, cost = cost_of(differences, 0);
    // The likelihood may have several peaks: first where the highest is, then where it ends.
    constexpr int steps = 200;
    const double low = std::max(1e-3 * least, 1e-12 * largest);
    if (!(largest > low)) return 0;
    const double factor = std::pow(largest / low, 1.0 / steps);
    for (double tau2 = low; tau2 <= largest * factor; tau2 *= factor)
        if (const double now = cost_of(differences, tau2); now < cost) best = tau2, cost = now;
    for (double width = factor; best > 0 && width > 1 + 1e-9; width = std::sqrt(width))
        for (const double tau2 : {best / width, best * width})
            if (const double now = cost_of(differences, tau2); now < cost) best = tau2, cost = now;
    return best;
}

// A difference that is mostly noise counts in part.
std::uint32_t freedom_of(const std::vector<Difference>& differences, double tau2)
{
    if (!(tau2 > 0)) return static_cast<std::uint32_t>(differences.size());
    double freedom = 0;
    for (const Difference& d : differences) freedom += std::pow(tau2 / (tau2 + d.variance), 2);
    return std::max(1u, static_cast<std::uint32_t>(std::lround(freedom)));
}

}  // namespace

void StationEvidence::add(const std::vector<std::uint32_t>& stations, const std::vector<double>& h,
                          const std::vector<double>& u, double noise)
{
    if (!(noise > 0)) return;
    const double weight = 1 / (noise * noise);
    const std::size_t columns = 3 * stations.size();
    for (std::size_t s = 0; s < stations.size(); ++s) {
        Vec3d& pull = pulls_[stations[s]];
        for (std::size_t a = 0; a < 3; ++a) pull[a] += weight * u[3 * s + a];
        for (std::size_t t = 0; t < stations.size(); ++t) {
            std::array<double, 9>& to = products_[{stations[s], stations[t]}];
            for (std::size_t a = 0; a < 3; ++a)
                for (std::size_t b = 0; b < 3; ++b) to[3 * a + b] += weight * h[(3 * s + a) * columns + 3 * t + b];
        }
    }
}

void StationEvidence::add(const StationEvidence& other)
{
    for (const auto& [pair, product] : other.products_) {
        std::array<double, 9>& to = products_[pair];
        for (std::size_t k = 0; k < 9; ++k) to[k] += product[k];
    }
    for (const auto& [station, pull] : other.pulls_) pulls_[station] = pulls_[station] + pull;
}

double StationEvidence::deviation_from(const std::map<std::uint32_t, Vec3d>& shifts) const
{
    std::map<std::uint32_t, Vec3d> left = pulls_;
    double weight = 0, squares = 0;
    for (const auto& [pair, product] : products_) {
        if (pair.first == pair.second) weight += product[0] + product[4] + product[8];
        const auto shift = shifts.find(pair.second);
        if (shift == shifts.end()) continue;
        Vec3d& to = left.at(pair.first);
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b) to[a] -= product[3 * a + b] * shift->second[b];
    }
    for (const auto& [station, pull] : left) squares += dot(pull, pull);
    return weight > 0 ? std::sqrt(squares) / weight : 0;
}

StationSpread StationEvidence::spread(double alike) const
{
    StationSpread result;
    std::map<std::uint32_t, Eigen::Index> place;
    for (const auto& [station, pull] : pulls_)
        if (place.size() < most_stations) place.emplace(station, 3 * static_cast<Eigen::Index>(place.size()));
    result.stations = place.size();
    const auto size = 3 * static_cast<Eigen::Index>(place.size());
    if (size == 0) return result;
    SpreadMatrix h = SpreadMatrix::Zero(size, size);
    SpreadVector u = SpreadVector::Zero(size);
    for (const auto& [pair, product] : products_) {
        const auto s = place.find(pair.first), t = place.find(pair.second);
        if (s == place.end() || t == place.end()) continue;
        for (Eigen::Index a = 0; a < 3; ++a)
            for (Eigen::Index b = 0; b < 3; ++b)
                h(s->second + a, t->second + b) = product[static_cast<std::size_t>(3 * a + b)];
    }
    for (const auto& [station, at] : place)
        for (std::size_t a = 0; a < 3; ++a) u[at + static_cast<Eigen::Index>(a)] = pulls_.at(station)[a];
    const Eigen::SelfAdjointEigenSolver<SpreadMatrix> system(h);
    const SpreadVector turned = system.eigenvectors().transpose() * u;
    const double most = system.eigenvalues()[size - 1];
    // Where points hardly distinguish a shift from a change of the shape they show nothing of it.
    constexpr double weakest = 1e-3;
    std::vector<Difference> differences;
    for (Eigen::Index k = 0; k < size; ++k)
        if (const double lambda = system.eigenvalues()[k]; lambda > weakest * most)
            differences.push_back({std::pow(turned[k] / lambda, 2), alike * alike / lambda});
    if (differences.empty()) return result;
    const double tau2 = most_probable(differences);
    result.spread = std::sqrt(tau2);
    result.freedom = freedom_of(differences, tau2);
    SpreadVector part = SpreadVector::Zero(size);
    for (Eigen::Index k = 0; k < size; ++k)
        if (const double lambda = system.eigenvalues()[k]; lambda > weakest * most)
            part[k] = turned[k] * tau2 / (tau2 * lambda + alike * alike);
    const SpreadVector shifts = system.eigenvectors() * part;
    for (const auto& [station, at] : place) result.shifts[station] = {shifts[at], shifts[at + 1], shifts[at + 2]};
    return result;
}

double student_factor(std::uint32_t freedom)
{
    if (freedom == 0) return 1;
    if (freedom == 1) return 1.8373;
    if (freedom == 2) return 1.3213;
    const double n = freedom;
    return 1 + 0.5 / n + 0.27 / (n * n);
}

}  // namespace pcm
