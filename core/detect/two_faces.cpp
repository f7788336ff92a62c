#include "pcm/detect/two_faces.h"

#include "pcm/cloud/numbers.h"
#include "pcm/shapes/axis_frame.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

// Heights h over a plane as a + b u + c v, a that of the face.
struct StationHeights {
    std::uint32_t station = 0;
    double points = 0;
    Eigen::Vector3d sums = Eigen::Vector3d::Zero();     // sums of 1, u, v
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();  // sums of u, v
    Eigen::Vector3d heights = Eigen::Vector3d::Zero();  // sums of h, h u, h v
    double squared = 0;                                 // sums of h^2

    double mean() const { return heights[0] / points; }
    // Sum of squared distances from a + b u + c v.
    double misfit(double a, double b, double c) const
    {
        return squared - 2 * (a * heights[0] + b * heights[1] + c * heights[2]) + a * a * points +
               2 * a * (b * sums[1] + c * sums[2]) + b * b * squares(0, 0) + 2 * b * c * squares(0, 1) +
               c * c * squares(1, 1);
    }
};

// Two parallel planes, or one twice.
struct Solution {
    std::array<double, 2> a{};
    double b = 0, c = 0, misfit = infinity;
};

class Division {
public:
    Division(const Shape& plane, const std::vector<PointOfStation>& points) : plane_(plane), frame_(plane.axis)
    {
        for (const PointOfStation& p : points) middle_ = middle_ + (p.place - plane.point);
        middle_ = plane.point + middle_ / static_cast<double>(std::max<std::size_t>(points.size(), 1));
        std::map<std::uint32_t, StationHeights> all;
        for (const PointOfStation& p : points) add(p, all[p.station]);
        for (auto& [station, one] : all) {
            one.station = station;
            stations_.push_back(one);
            points_ += one.points;
        }
        std::sort(stations_.begin(), stations_.end(),
                  [](const StationHeights& x, const StationHeights& y) { return x.mean() < y.mean(); });
    }

    std::optional<TwoFaces> best(double left) const
    {
        const std::size_t count = stations_.size();
        const auto one = solved(std::vector<std::size_t>(count, 0));
        if (count < 2 || !one) return std::nullopt;
        std::vector<std::size_t> faces;
        Solution best;
        for (std::size_t cut = 1; cut < count; ++cut) {
            std::vector<std::size_t> here(count, 0);
            std::fill(here.begin() + static_cast<std::ptrdiff_t>(cut), here.end(), 1);
            const Solution found = settled(here);
            if (!(found.misfit < best.misfit)) continue;
            best = found;
            faces = here;
        }
        if (faces.empty()) return std::nullopt;
        TwoFaces result;
        std::array<double, 2> seen{};
        for (std::size_t s = 0; s < count; ++s) {
            result.face_of[stations_[s].station] = faces[s];
            ++seen[faces[s]];
        }
        for (const std::size_t face : {0, 1}) result.planes[face] = plane_of(best, face);
        result.apart = std::fabs(best.a[1] - best.a[0]) / std::sqrt(1 + best.b * best.b + best.c * best.c);
        result.certainty = result.apart / (left * std::sqrt(1 / seen[0] + 1 / seen[1]));
        result.noise = std::sqrt(std::max(0.0, best.misfit) / points_);
        result.noise_as_one = std::sqrt(std::max(0.0, one->misfit) / points_);
        return result;
    }

private:
    void add(const PointOfStation& p, StationHeights& to) const
    {
        const Vec3d d = p.place - middle_;
        const double u = dot(d, frame_.u), v = dot(d, frame_.v), h = dot(d, frame_.axis);
        const Eigen::Vector3d row(1, u, v);
        to.points += 1;
        to.sums += row;
        to.squares += row.tail<2>() * row.tail<2>().transpose();
        to.heights += h * row;
        to.squared += h * h;
    }

    // Each station on the nearer face, until none changes.
    Solution settled(std::vector<std::size_t>& faces) const
    {
        Solution solution;
        for (std::size_t round = 0; round <= stations_.size(); ++round) {
            const auto next = solved(faces);
            if (!next) return {};
            solution = *next;
            std::vector<std::size_t> nearer;
            for (const StationHeights& s : stations_)
                nearer.push_back(s.misfit(solution.a[1], solution.b, solution.c) <
                                 s.misfit(solution.a[0], solution.b, solution.c));
            if (std::count(nearer.begin(), nearer.end(), nearer.front()) == static_cast<std::ptrdiff_t>(nearer.size()))
                return {};
            if (nearer == faces) break;
            faces = std::move(nearer);
        }
        return solution;
    }

    std::optional<Solution> solved(const std::vector<std::size_t>& faces) const
    {
        Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
        Eigen::Vector4d right = Eigen::Vector4d::Zero();
        for (std::size_t s = 0; s < stations_.size(); ++s) {
            const StationHeights& one = stations_[s];
            const auto f = static_cast<Eigen::Index>(faces[s]);
            normal(f, f) += one.points;
            normal.block<1, 2>(f, 2) += one.sums.tail<2>().transpose();
            normal.bottomRightCorner<2, 2>() += one.squares;
            right[f] += one.heights[0];
            right.tail<2>() += one.heights.tail<2>();
        }
        for (const Eigen::Index f : {0, 1})
            if (normal(f, f) == 0) normal(f, f) = 1;
        normal.bottomLeftCorner<2, 2>() = normal.topRightCorner<2, 2>().transpose();
        const Eigen::LDLT<Eigen::Matrix4d> factors(normal);
        const auto diagonal = factors.vectorD();
        if (factors.info() != Eigen::Success || !(diagonal.minCoeff() > 1e-12 * diagonal.maxCoeff()))
            return std::nullopt;
        const Eigen::Vector4d x = factors.solve(right);
        Solution solution{{x[0], x[1]}, x[2], x[3], 0};
        for (std::size_t s = 0; s < stations_.size(); ++s)
            solution.misfit += stations_[s].misfit(solution.a[faces[s]], solution.b, solution.c);
        return solution;
    }

    Shape plane_of(const Solution& solution, std::size_t face) const
    {
        Shape plane = plane_;
        plane.point = middle_ + solution.a[face] * frame_.axis;
        plane.axis = normalised(frame_.axis - solution.b * frame_.u - solution.c * frame_.v);
        return plane;
    }

    const Shape plane_;
    const AxisFrame frame_;
    Vec3d middle_{};
    std::vector<StationHeights> stations_;  // lowest mean first
    double points_ = 0;
};

}  // namespace

std::optional<TwoFaces> two_faces(const Shape& plane, const std::vector<PointOfStation>& points, double left)
{
    return Division(plane, points).best(left);
}

}  // namespace pcm
