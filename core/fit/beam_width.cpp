#include "pcm/fit/beam_width.h"

#include "pcm/fit/tuning.h"
#include "pcm/shapes/axis_frame.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double little = 1e-6;  // share of a direction's products that keeps shifts determined

// What the equations have of a place: derivatives of its distance by the shape's parameters, by the variance and by the
// shift of its station.
struct BeamRow {
    VectorXd by;
    double distance = 0;
};

class BeamRows {
public:
    BeamRows(const ShapeModel& model, const SurfacePatch& patch, double step)
        : model_(model), patch_(patch), shape_(model.shape_of(patch)), step_(step)
    {
    }

    BeamRow at(const Vec3d& place, const Vec3d& ray) const
    {
        const Vec3d normal = normal_at(shape_, place);
        const double cosine = std::max(dot(normal, ray), fit_tuning().ray_errors.min_beam_cosine);
        const Vec3d across = normal - dot(normal, ray) * ray;
        const double size = length(across);
        const Vec3d first = size > 1e-6 ? (1 / size) * across : AxisFrame(ray).u, second = cross(ray, first);
        const Vec3d slanted = first - (dot(normal, first) / cosine) * ray;
        std::array<std::array<double, 5>, 3> at{};
        for (std::size_t a = 0; a < 3; ++a)
            at[a] = {place[a], place[a] - step_ * slanted[a], place[a] + step_ * slanted[a],
                     place[a] - step_ * second[a], place[a] + step_ * second[a]};
        PatchBlock block;
        model_.differentiate(patch_, at[0].data(), at[1].data(), at[2].data(), 5, block);
        const auto parameters = static_cast<Index>(model_.parameters());
        BeamRow row{VectorXd(parameters + 4), block.distance[0]};
        for (Index j = 0; j < parameters; ++j) row.by[j] = block.by[static_cast<std::size_t>(j)][0];
        row.by[parameters] =
            -(block.distance[1] + block.distance[2] + block.distance[3] + block.distance[4] - 4 * row.distance) /
            (2 * step_ * step_);
        for (Index a = 0; a < 3; ++a) row.by[parameters + 1 + a] = normal[static_cast<std::size_t>(a)];
        return row;
    }

    // What errors of this variance along the ray add to the right side of the equations (ray_errors.h).
    VectorXd noise_at(const BeamRow& row, const Vec3d& place, const Vec3d& ray, double variance) const
    {
        const BeamRow before = at(place - step_ * ray, ray), after = at(place + step_ * ray, ray);
        const double bend = (before.distance + after.distance - 2 * row.distance) / (step_ * step_);
        const double slope = (after.distance - before.distance) / (2 * step_);
        return variance * (bend / 2 * row.by + slope / (2 * step_) * (after.by - before.by));
    }

private:
    const ShapeModel& model_;
    const SurfacePatch& patch_;
    const Shape shape_;
    const double step_;
};

// Normal equations of the shape's parameters, the variance and the stations' shifts, in this order.
class BeamEquations {
public:
    BeamEquations(std::size_t parameters, std::size_t stations)
        : parameters_(static_cast<Index>(parameters)),
          products_(MatrixXd::Zero(size_with(stations), size_with(stations))),
          pulls_(VectorXd::Zero(size_with(stations)))
    {
    }

    void add(const BeamRow& row, const VectorXd& noise, Index station)
    {
        const auto place = [&](Index k) { return k <= parameters_ ? k : k + 3 * station; };
        for (Index j = 0; j < row.by.size(); ++j) {
            pulls_[place(j)] += row.by[j] * row.distance - noise[j];
            for (Index k = 0; k < row.by.size(); ++k) products_(place(j), place(k)) += row.by[j] * row.by[k];
        }
        squares_ += row.distance * row.distance;
        points_ += 1;
    }

    BeamWidth width(double widest) const
    {
        BeamWidth result;
        for (Index j = 0; j < parameters_; ++j) result.pulls[static_cast<std::size_t>(j)] = products_(j, parameters_);
        const double noise = squares_ / points_;  // variance
        MatrixXd system = products_;
        system(parameters_, parameters_) += noise / std::pow(widest, 4);
        for (Index k = parameters_ + 1; k < system.rows(); ++k) system(k, k) += little * points_;
        const Eigen::LDLT<MatrixXd> solver = system.ldlt();
        const VectorXd answer = solver.solve(pulls_), unit = VectorXd::Unit(system.rows(), parameters_);
        const double left = std::max(0.0, squares_ - answer.dot(pulls_)) / points_;
        const double variance = left * solver.solve(unit)[parameters_];
        if (!answer.allFinite() || !(variance > 0)) return result;
        result.variance = std::max(0.0, answer[parameters_]);
        result.error = std::sqrt(variance);
        return result;
    }

private:
    Index size_with(std::size_t stations) const { return parameters_ + 1 + 3 * static_cast<Index>(stations); }

    const Index parameters_;
    MatrixXd products_;
    VectorXd pulls_;
    double squares_ = 0, points_ = 0;
};

}  // namespace

BeamWidth beam_width(const ShapeModel& model, const SurfacePatch& patch,
                     const std::map<std::uint32_t, StationRays>& stations, double widest, double step)
{
    const BeamRows rows(model, patch, step);
    BeamEquations equations(model.parameters(), stations.size());
    Index number = 0;
    for (const auto& [station, rays] : stations) {
        for (const PointOnShape& p : rays.points) {
            if (!(dot(p.normal, rays.direction) > fit_tuning().ray_errors.min_beam_cosine)) continue;
            const BeamRow row = rows.at(p.place, rays.direction);
            equations.add(row, rows.noise_at(row, p.place, rays.direction, rays.noise), number);
        }
        ++number;
    }
    return equations.width(widest);
}

}  // namespace pcm
