#include "pcm/place/departure.h"

#include "pcm/fit/models/shape_model.h"
#include "pcm/fit/station_spread.h"
#include "pcm/fit/working_points.h"
#include "pcm/place/error_agreement.h"
#include "pcm/place/even_noise.h"
#include "pcm/place/tuning.h"
#include "pcm/system/text.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>

namespace pcm {
namespace {

constexpr std::size_t most_looked_at = 2000, least_points = 60;
constexpr int variables = 6, terms = 84;  // monomials of up to third degree in six variables: (6 + 3 over 3)
constexpr double least_singular = 1e-3;   // relative to the largest; below it, monomials are dependent on the shape
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
    std::vector<std::size_t> station;                     // index from 0; empty: one station
    std::vector<std::array<double, most_parameters>> by;  // derivatives by the shape's parameters; for several stations
    std::size_t parameters = 0;
    std::size_t stations = 0;
};

// In units of the points' extent, in which all parameters are of one size.
void differentiate(const Shape& shape, const std::vector<Vec3d>& places, OnShape& on)
{
    Box3d box;
    for (const Vec3d& p : places) box.extend(p);
    const double extent = box.diagonal() > 0 ? box.diagonal() : 1;
    const ShapeModel& model = model_of(shape.kind);
    const SurfacePatch patch = model.patch_at(scaled(shape, box.centre(), extent), {});
    on.parameters = model.parameters();
    for (const Vec3d& p : places) {
        const Vec3d at = (1 / extent) * (p - box.centre());
        PatchBlock block;
        model.differentiate(patch, &at[0], &at[1], &at[2], 1, block);
        std::array<double, most_parameters>& by = on.by.emplace_back();
        for (std::size_t j = 0; j < on.parameters; ++j) by[j] = block.by[j][0];
    }
}

OnShape on_shape(const Shape& shape, double threshold, const std::vector<Vec3d>& points,
                 const ShiftedStations* stations)
{
    std::map<std::uint32_t, std::size_t> indices;
    OnShape on;
    std::vector<Vec3d> places;
    for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / most_looked_at) {
        const double d = signed_distance(shape, points[i]);
        if (!(std::fabs(d) <= threshold)) continue;
        const Vec3d normal = normal_at(shape, points[i]);
        on.foot.push_back(points[i] - points.front() - d * normal);
        on.normal.push_back(normal);
        on.distance.push_back(d);
        if (stations) places.push_back(points[i]);
        if (stations) on.station.push_back(indices.emplace(stations->numbers[i], indices.size()).first->second);
    }
    on.stations = indices.size();
    if (stations && !places.empty()) differentiate(shape, places, on);
    return on;
}

// Agreement of what the polynomial leaves, in cubes as those of growth.
double agreement_of(const OnShape& on, const std::vector<double>& rest)
{
    Box3d box;
    for (const Vec3d& p : on.foot) box.extend(p);
    ErrorAgreement errors(box.min, box.diagonal() / place_tuning().growth.agreement_cubes);
    for (std::size_t i = 0; i < rest.size(); ++i) errors.add(on.foot[i], rest[i]);
    return errors.factor();
}

// Least squares of the distances by a polynomial, and by shifts of the stations, which a prior keeps near their spread.
// Shifts have moved the shape that was fitted to all stations as one, so with them its own parameters are free, too.
class SmoothSurface {
public:
    SmoothSurface(const OnShape& on, const ShiftedStations* stations)
        : on_(on), columns_(static_cast<Eigen::Index>(3 * on.stations + on.parameters))
    {
        if (stations) prior_ = std::pow(stations->noise / stations->spread, 2);
        across_ = Eigen::MatrixXd::Zero(columns_, terms);
        pulls_ = Eigen::VectorXd::Zero(columns_);
        Eigen::MatrixXd normals = prior_ * Eigen::MatrixXd::Identity(columns_, columns_);
        const auto own = static_cast<Eigen::Index>(on.parameters);
        normals.bottomRightCorner(own, own).diagonal().setConstant(1e-6);  // what the points do not determine
        for (std::size_t i = 0; i < on.distance.size(); ++i) add(i, normals);
        if (columns_ == 0) return;
        shifts_.compute(normals);
        a_.triangularView<Eigen::StrictlyUpper>() = a_.transpose();
        a_ -= across_.transpose() * shifts_.solve(across_);
        b_ -= across_.transpose() * shifts_.solve(pulls_);
        squares_ -= pulls_.dot(shifts_.solve(pulls_));
    }

    Departure departure()
    {
        if (!(squares_ > 0)) return {};
        const Eigen::SelfAdjointEigenSolver<Matrix> system(a_);
        const std::size_t count = on_.distance.size();
        double gain = 0, rank = 0;
        for (Eigen::Index k = terms; k-- > 0;) {
            const double value = system.eigenvalues()[k];
            if (!(value > least_singular * least_singular * system.eigenvalues()[terms - 1])) break;
            if (static_cast<std::size_t>(rank + 1) * least_per_term > count) break;
            const double along = system.eigenvectors().col(k).dot(b_);
            gain += along * along / value;
            x_ += along / value * system.eigenvectors().col(k);
            rank += 1;
        }
        const auto n = static_cast<double>(count), freedom = n - rank - static_cast<double>(columns_);
        if (!(freedom > 0)) return {};
        const double variance = std::max(squares_ - gain, 0.0) / freedom;
        Departure result;
        result.points = count;
        result.share = std::max(0.0, 1 - variance / (squares_ / n));
        result.size = std::sqrt(result.share * squares_ / n);
        result.rest = std::sqrt(variance);
        result.agreement = agreement_of(on_, rest());
        result.is_chance = !is_more_noise(gain / rank, rank, variance, freedom);
        return result;
    }

private:
    void add(std::size_t i, Eigen::MatrixXd& normals)
    {
        const Vec3d& n = on_.normal[i];
        rows_.push_back(monomials({n[0], n[1], n[2], on_.foot[i][0], on_.foot[i][1], on_.foot[i][2]}));
        const Vector& row = rows_.back();
        const double d = on_.distance[i];
        a_.selfadjointView<Eigen::Lower>().rankUpdate(row);
        b_ += d * row;
        squares_ += d * d;
        if (columns_ == 0) return;
        const Eigen::VectorXd by = column(i);
        for (Eigen::Index k = 0; k < columns_; ++k) {
            if (by[k] == 0) continue;
            normals.row(k) += by[k] * by.transpose();
            across_.row(k) += by[k] * row.transpose();
        }
        pulls_ += d * by;
    }

    // Derivatives of a distance by the shifts and the shape's parameters.
    Eigen::VectorXd column(std::size_t i) const
    {
        Eigen::VectorXd by = Eigen::VectorXd::Zero(columns_);
        for (std::size_t axis = 0; axis < 3; ++axis)
            by[static_cast<Eigen::Index>(3 * on_.station[i] + axis)] = on_.normal[i][axis];
        for (std::size_t j = 0; j < on_.parameters; ++j)
            by[static_cast<Eigen::Index>(3 * on_.stations + j)] = on_.by[i][j];
        return by;
    }

    // What polynomial and shifts leave.
    std::vector<double> rest() const
    {
        const Eigen::VectorXd shifts = columns_ ? Eigen::VectorXd(shifts_.solve(pulls_ - across_ * x_)) : pulls_;
        std::vector<double> rest;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            rest.push_back(on_.distance[i] - rows_[i].dot(x_));
            if (columns_ > 0) rest.back() -= column(i).dot(shifts);
        }
        return rest;
    }

    const OnShape& on_;
    const Eigen::Index columns_;  // number of shifts and parameters of the shape
    double prior_ = 0;
    Matrix a_ = Matrix::Zero();
    Vector b_ = Vector::Zero(), x_ = Vector::Zero();
    std::vector<Vector> rows_;
    double squares_ = 0;
    Eigen::MatrixXd across_;
    Eigen::VectorXd pulls_;
    Eigen::LDLT<Eigen::MatrixXd> shifts_;
};

Departure smooth_departure(const Shape& shape, double threshold, const std::vector<Vec3d>& points,
                           const ShiftedStations* stations)
{
    OnShape on = on_shape(shape, threshold, points, stations);
    const std::size_t count = on.distance.size();
    if (count < least_points) return {};
    if (stations && (on.stations < 2 || on.stations > StationEvidence::most_stations)) return {};
    Vec3d middle{};
    for (const Vec3d& p : on.foot) middle = middle + (1 / static_cast<double>(count)) * p;
    double size = 0;
    for (const Vec3d& p : on.foot) size = std::max(size, length(p - middle));
    if (!(size > 0)) return {};
    for (Vec3d& p : on.foot) p = (1 / size) * (p - middle);
    return SmoothSurface(on, stations).departure();
}

}  // namespace

bool Departure::is_smooth(double noise) const
{
    const DepartureTuning& tuned = place_tuning().departure;
    return !is_chance && share > tuned.min_share && noise > 0 && rest < tuned.max_rest * noise &&
           agreement < tuned.max_agreement;
}

bool Departure::is_dominant(double noise) const
{
    const DepartureTuning& tuned = place_tuning().departure;
    return !is_chance && share > tuned.min_dominant_share && noise > 0 && size > tuned.min_dominant_size * noise;
}

std::string Departure::message(const std::string& shape) const
{
    return "the points leave the " + shape + " together by " + brief(size) + " (root mean square) and are within " +
           brief(rest) + " of a smooth surface: it is out of round, bent or bulged by that";
}

Departure departure_of(const Shape& shape, double threshold, const std::vector<Vec3d>& points)
{
    return smooth_departure(shape, threshold, points, nullptr);
}

Departure departure_of(const Shape& shape, double threshold, const std::vector<Vec3d>& points,
                       const ShiftedStations& stations)
{
    return smooth_departure(shape, threshold, points, &stations);
}

}  // namespace pcm
