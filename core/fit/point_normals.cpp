#include "pcm/fit/point_normals.h"

#include "pcm/cloud/numbers.h"
#include "pcm/fit/shape_fit.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace pcm {
namespace {

constexpr std::size_t sample_neighbours = 16;

}  // namespace

PlaneNear plane_near(const NearTree& tree, const std::vector<double>& x, const std::vector<double>& y,
                     const std::vector<double>& z, const Vec3d& place, std::size_t neighbours,
                     std::vector<NearTree::Near>& near)
{
    tree.nearest(place, neighbours, near);
    if (near.size() < 3) return {};
    const double size = std::sqrt(near.back().square);
    if (!(size > 0)) return {};
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    for (const NearTree::Near& one : near) {
        const Vec3d d = (Vec3d{x[one.index], y[one.index], z[one.index]} - place) / size;
        const Eigen::Vector3d v(d[0], d[1], d[2]);
        sum += v;
        products += v * v.transpose();
    }
    const auto n = static_cast<double>(near.size());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> system(products / n - (sum / n) * (sum / n).transpose());
    if (!(system.eigenvalues()[1] > 1e-14)) return {};
    const Eigen::Vector3d normal = system.eigenvectors().col(0);
    return {{normal[0], normal[1], normal[2]}, size * std::sqrt(std::max(0.0, system.eigenvalues()[0]))};
}

const NearTree& SampleNormals::tree()
{
    if (!tree_) tree_ = std::make_unique<NearTree>(points_.x, points_.y, points_.z);
    return *tree_;
}

double SampleNormals::unevenness(std::size_t i)
{
    const PlaneNear plane =
        plane_near(tree(), points_.x, points_.y, points_.z, points_.at(i), sample_neighbours, near_);
    return dot(plane.normal, plane.normal) > 0 ? plane.rms : infinity;
}

Vec3d SampleNormals::at(std::size_t i)
{
    if (points_.has_normals()) return points_.normal(i);
    if (known_.empty()) {
        known_.resize(points_.size());
        is_known_.resize(points_.size());
    }
    if (!is_known_[i])
        known_[i] = plane_near(tree(), points_.x, points_.y, points_.z, points_.at(i), sample_neighbours, near_).normal;
    is_known_[i] = true;
    return known_[i];
}

void estimate_normals(FitPoints& points, std::size_t neighbours)
{
    const std::size_t n = points.size();
    points.nx.assign(n, 0);
    points.ny.assign(n, 0);
    points.nz.assign(n, 0);
    // Points that are not finite are ignored.
    std::vector<double> x, y, z;
    std::vector<std::uint32_t> index;
    for (std::size_t i = 0; i < n; ++i)
        if (is_finite(points.at(i))) {
            x.push_back(points.x[i]);
            y.push_back(points.y[i]);
            z.push_back(points.z[i]);
            index.push_back(static_cast<std::uint32_t>(i));
        }
    const NearTree tree(x, y, z);
    std::vector<NearTree::Near> near;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Vec3d normal = plane_near(tree, x, y, z, {x[i], y[i], z[i]}, neighbours, near).normal;
        points.nx[index[i]] = normal[0];
        points.ny[index[i]] = normal[1];
        points.nz[index[i]] = normal[2];
    }
}

}  // namespace pcm
