#include "pcm/place/departure.h"

#include "pcm/place/error_agreement.h"
#include "pcm/place/even_noise.h"
#include "pcm/place/tuning.h"
#include "pcm/system/text.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pcm {
namespace {

constexpr std::size_t most_points = 2000, least_points = 60;
constexpr int variables = 6, terms = 84;  // monomials of up to third degree in six variables: (6 + 3 over 3)
constexpr double least_singular = 1e-3;   // relative to the largest one: monomials that are alike on the shape
constexpr std::size_t least_per_term = 10;

using Vector = Eigen::Matrix<double, terms, 1>;
using Matrix = Eigen::Matrix<double, terms, terms>;

Vector monomials(const std::array<double, variables>& x)
{
    Vector row;
    Eigen::Index at = 0;
    row[at++] = 1;
    for (std::size_t a = 0; a < variables; ++a) {
        row[at++] = x[a];
        for (std::size_t b = a; b < variables; ++b) {
            row[at++] = x[a] * x[b];
            for (std::size_t c = b; c < variables; ++c) row[at++] = x[a] * x[b] * x[c];
        }
    }
    return row;
}

struct OnShape {
    std::vector<Vec3d> foot, normal;  // the foot about the first of the points
    std::vector<double> distance;
};

OnShape on_shape(const Shape& shape, double threshold, const std::vector<Vec3d>& points)
{
    OnShape on;
    for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / most_points) {
        const double d = signed_distance(shape, points[i]);
        if (!(std::fabs(d) <= threshold)) continue;
        const Vec3d normal = normal_at(shape, points[i]);
        on.foot.push_back(points[i] - points.front() - d * normal);
        on.normal.push_back(normal);
        on.distance.push_back(d);
    }
    return on;
}

// Agreement of what the polynomial leaves, in cubes as those of growth.
double agreement_of(const OnShape& on, const std::vector<double>& rest)
{
    Box3d box;
    for (const Vec3d& p : on.foot) box.extend(p);
    ErrorAgreement alike(box.min, box.diagonal() / place_tuning().growth.agreement_cubes);
    for (std::size_t i = 0; i < rest.size(); ++i) alike.add(on.foot[i], rest[i]);
    return alike.factor();
}

}  // namespace

bool Departure::is_smooth(double noise) const
{
    const DepartureTuning& tuned = place_tuning().departure;
    return !is_chance && share > tuned.min_share && noise > 0 && rest < tuned.max_rest * noise &&
           agreement < tuned.max_agreement;
}

std::string Departure::message(const std::string& shape) const
{
    return "the points leave the " + shape + " together by " + brief(size) + " (root mean square) and are within " +
           brief(rest) + " of a smooth surface: it is out of round, bent or bulged by that";
}

Departure departure_of(const Shape& shape, double threshold, const std::vector<Vec3d>& points)
{
    const OnShape on = on_shape(shape, threshold, points);
    const std::size_t count = on.distance.size();
    if (count < least_points) return {};
    Vec3d middle{};
    for (const Vec3d& p : on.foot) middle = middle + (1 / static_cast<double>(count)) * p;
    double size = 0;
    for (const Vec3d& p : on.foot) size = std::max(size, length(p - middle));
    if (!(size > 0)) return {};
    Matrix a = Matrix::Zero();
    Vector b = Vector::Zero(), x = Vector::Zero();
    std::vector<Vector> rows;
    double squares = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d at = (1 / size) * (on.foot[i] - middle), &n = on.normal[i];
        rows.push_back(monomials({n[0], n[1], n[2], at[0], at[1], at[2]}));
        const Vector& row = rows.back();
        a.selfadjointView<Eigen::Lower>().rankUpdate(row);
        b += on.distance[i] * row;
        squares += on.distance[i] * on.distance[i];
    }
    if (!(squares > 0)) return {};
    const Eigen::SelfAdjointEigenSolver<Matrix> system(a);
    double gain = 0, rank = 0;
    for (Eigen::Index k = terms; k-- > 0;) {
        const double value = system.eigenvalues()[k];
        if (!(value > least_singular * least_singular * system.eigenvalues()[terms - 1])) break;
        if (static_cast<std::size_t>(rank + 1) * least_per_term > count) break;
        const double along = system.eigenvectors().col(k).dot(b);
        gain += along * along / value;
        x += along / value * system.eigenvectors().col(k);
        rank += 1;
    }
    const auto n = static_cast<double>(count);
    const double left = std::max(squares - gain, 0.0), variance = left / (n - rank);
    Departure result;
    result.points = count;
    result.share = std::max(0.0, 1 - variance / (squares / n));
    result.size = std::sqrt(result.share * squares / n);
    result.rest = std::sqrt(variance);
    std::vector<double> rest;
    for (std::size_t i = 0; i < count; ++i) rest.push_back(on.distance[i] - rows[i].dot(x));
    result.agreement = agreement_of(on, rest);
    result.is_chance = !is_more_noise(gain / rank, rank, variance, n - rank);
    return result;
}

}  // namespace pcm
