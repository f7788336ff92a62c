// Gauss-Newton of geometric distances in long double, with derivatives by differences: slow, simple, and shares no code
// with fit/.
#include "bench/fit/fit_scene.h"

#include <Eigen/Dense>

namespace pcm::bench {
namespace {

using Real = long double;
using V3 = Eigen::Matrix<Real, 3, 1>;
using Parameters = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

V3 of(const Vec3d& v) { return {Real(v[0]), Real(v[1]), Real(v[2])}; }

// A shape near the truth, by what may change: the place across its axis (or all of it), the direction of the axis, the
// curvature (1 / radius) or the cone's angle. Where the middle touches the surface the place is measured, so that large
// radii move it little.
class Nearby {
public:
    Nearby(const FitScene& scene, const std::vector<V3>& points) : kind_(scene.truth.kind), points_(points)
    {
        const Shape& t = scene.truth;
        axis_ = of(t.axis).normalized();
        u_ = axis_.unitOrthogonal();
        v_ = axis_.cross(u_);
        const V3 from = of(scene.middle) - of(t.point);
        centre_ = -from;  // relative to the middle
        if (kind_ == ShapeKind::sphere) out_ = from.norm() > 0.1L * t.radius ? V3(from.normalized()) : V3::Zero();
        if (kind_ == ShapeKind::cylinder) {
            const V3 across = from - from.dot(axis_) * axis_;
            centre_ = centre_ + from.dot(axis_) * axis_;  // the place of the axis that is nearest to the middle
            out_ = across.norm() > 0.1L * t.radius ? V3(across.normalized()) : V3::Zero();
        }
        radius_ = t.radius;
        angle_ = t.second;
    }

    Eigen::Index size() const
    {
        return kind_ == ShapeKind::plane ? 3 : kind_ == ShapeKind::cylinder ? 5 : kind_ == ShapeKind::sphere ? 4 : 6;
    }

    struct Values {
        V3 centre, axis;
        Real radius, angle;
    };
    Values at(const Parameters& p) const
    {
        Values x{centre_, axis_, radius_, angle_};
        if (kind_ == ShapeKind::plane || kind_ == ShapeKind::cylinder || kind_ == ShapeKind::cone)
            x.axis = (axis_ + p[0] * u_ + p[1] * v_).normalized();
        if (kind_ == ShapeKind::plane) x.centre += p[2] * axis_;
        if (kind_ == ShapeKind::cylinder) {
            x.radius = 1 / (1 / radius_ + p[4]);
            x.centre += p[2] * u_ + p[3] * v_ - (x.radius - radius_) * out_;
        }
        if (kind_ == ShapeKind::sphere) {
            x.radius = 1 / (1 / radius_ + p[3]);
            x.centre += p.head<3>() - (x.radius - radius_) * out_;
        }
        if (kind_ == ShapeKind::cone) {
            x.centre += p.segment<3>(2);
            x.angle += p[5];
        }
        return x;
    }

    Parameters distances(const Parameters& p) const
    {
        const Values x = at(p);
        Parameters result(static_cast<Eigen::Index>(points_.size()));
        for (Eigen::Index i = 0; i < result.size(); ++i) {
            const V3 d = points_[static_cast<std::size_t>(i)] - x.centre;
            const Real h = x.axis.dot(d), q = x.axis.cross(d).norm();
            result[i] = kind_ == ShapeKind::plane      ? h
                        : kind_ == ShapeKind::cylinder ? q - x.radius
                        : kind_ == ShapeKind::sphere   ? d.norm() - x.radius
                                                       : q * std::cos(x.angle) - h * std::sin(x.angle);
        }
        return result;
    }

private:
    ShapeKind kind_;
    const std::vector<V3>& points_;
    V3 centre_, axis_, u_, v_, out_ = V3::Zero();
    Real radius_ = 0, angle_ = 0;
};

}  // namespace

Shape oracle(const FitScene& scene)
{
    std::vector<V3> points;
    Real extent = 0;
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
        if (!scene.on_shape[i]) continue;
        points.push_back(of(scene.points.origin) + of(scene.points.at(i)) - of(scene.middle));
        extent = std::max(extent, points.back().norm());
    }
    const Nearby near(scene, points);
    const Eigen::Index n = near.size();
    Parameters p = Parameters::Zero(n), residuals = near.distances(p);
    for (int step = 0; step < 60; ++step) {
        Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> jacobian(residuals.size(), n);
        Parameters scale(n);
        for (Eigen::Index k = 0; k < n; ++k) {
            Parameters a = p, b = p;
            const Real h = 1e-7L / (scene.truth.kind == ShapeKind::cylinder || scene.truth.kind == ShapeKind::sphere
                                        ? std::max<Real>(1, Real(scene.truth.radius))
                                        : 1);
            a[k] += h;
            b[k] -= h;
            jacobian.col(k) = (near.distances(a) - near.distances(b)) / (2 * h);
            scale[k] = 1 / std::max<Real>(jacobian.col(k).norm(), 1e-300L);
            jacobian.col(k) *= scale[k];
        }
        const Parameters change = -(scale.asDiagonal() * jacobian.householderQr().solve(residuals));
        Real share = 1;
        Parameters next = p + change, better = near.distances(next);
        while (better.squaredNorm() > residuals.squaredNorm() && share > 1e-6L) {
            share /= 2;
            next = p + share * change;
            better = near.distances(next);
        }
        const bool done = residuals.norm() - better.norm() <= 1e-13L * residuals.norm();
        if (better.squaredNorm() <= residuals.squaredNorm()) p = next, residuals = better;
        if (done) break;
    }
    const Nearby::Values x = near.at(p);
    Shape found = scene.truth;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto i = static_cast<Eigen::Index>(k);
        found.point[k] = static_cast<double>(of(scene.middle)[i] + x.centre[i]);
        found.axis[k] = static_cast<double>(x.axis[i]);
    }
    if (scene.truth.kind == ShapeKind::cylinder || scene.truth.kind == ShapeKind::sphere)
        found.radius = static_cast<double>(x.radius);
    if (scene.truth.kind == ShapeKind::cone) found.second = static_cast<double>(x.angle);
    return found;
}

}  // namespace pcm::bench
