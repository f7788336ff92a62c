#include "tests/oracle/disc_oracle.h"

#include <cmath>
#include <utility>
#include "pcm/cloud/vector.h"

namespace pcm::test {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

DiscOracle::DiscOracle(const Camera& view) : view_(view)
{
    Matrix4d& m = view_.modelview;
    Matrix4d& p = view_.projection;
    orthographic_ = p[3] == 0 && p[7] == 0 && p[11] == 0;
    const double affine = m[15];
    for (double& v : m) v /= affine;
    const double of_w = orthographic_ ? p[15] : -p[11];
    for (double& v : p) v /= of_w;

    // Gauss-Jordan with pivoting, in long double.
    long double a[3][6];
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) {
            a[r][c] = m[c * 4 + r];
            a[r][3 + c] = r == c ? 1 : 0;
        }
    for (std::size_t c = 0; c < 3; ++c) {
        std::size_t pivot = c;
        for (std::size_t r = c + 1; r < 3; ++r)
            if (std::abs(a[r][c]) > std::abs(a[pivot][c])) pivot = r;
        std::swap(a[c], a[pivot]);
        const long double diagonal = a[c][c];
        for (long double& v : a[c]) v /= diagonal;
        for (std::size_t r = 0; r < 3; ++r) {
            if (r == c) continue;
            const long double factor = a[r][c];
            for (std::size_t k = 0; k < 6; ++k) a[r][k] -= factor * a[c][k];
        }
    }
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t r = 0; r < 3; ++r) columns_[c][r] = static_cast<double>(a[r][3 + c]);
    for (std::size_t c = 0; c < 3; ++c) eye_ = eye_ - m[12 + c] * columns_[c];
    if (orthographic_) {
        near_ = (1 + p[14]) / p[10];
        far_ = (p[14] - 1) / p[10];
    } else {
        near_ = p[14] / (p[10] - 1);
        far_ = p[10] + 1 == 0 ? infinity : p[14] / (p[10] + 1);
    }
}

DiscOracle::Ray DiscOracle::ray(double x, double y) const
{
    const Matrix4d& p = view_.projection;
    const double ndc[2] = {2 * x / view_.width - 1, 2 * y / view_.height - 1};
    Ray ray;
    ray.depth = 0;
    if (orthographic_) {
        ray.origin = eye_ + ((ndc[0] - p[12]) / p[0]) * columns_[0] + ((ndc[1] - p[13]) / p[5]) * columns_[1];
        ray.direction = -1.0 * columns_[2];
    } else {
        ray.origin = eye_;
        ray.direction = ((ndc[0] + p[8]) / p[0]) * columns_[0] + ((ndc[1] + p[9]) / p[5]) * columns_[1] - columns_[2];
    }
    return ray;
}

double DiscOracle::hit(const Ray& ray, const Disc& disc) const
{
    const double slope = dot(ray.direction, disc.normal);
    if (slope == 0) return infinity;
    const Vec3d to_centre = disc.centre - ray.origin;
    const double depth = dot(to_centre, disc.normal) / slope;
    if (!(depth >= near_ && depth <= far_)) return infinity;
    const Vec3d offset = depth * ray.direction - to_centre;
    return dot(offset, offset) <= disc.radius * disc.radius ? depth : infinity;
}

DiscHit DiscOracle::cast(const std::vector<Disc>& discs, double x, double y, double margin) const
{
    DiscHit best;
    const Ray middle = ray(x, y);
    std::vector<Ray> around;
    for (int k = 0; k < 8 && margin > 0; ++k) {
        const double angle = pi / 4 * k;
        around.push_back(ray(x + margin * std::cos(angle), y + margin * std::sin(angle)));
    }
    for (std::size_t d = 0; d < discs.size(); ++d) {
        const double depth = hit(middle, discs[d]);
        for (const Ray& other : around)
            if ((hit(other, discs[d]) < infinity) != (depth < infinity)) best.certain = false;
        if (!(depth < best.runner_up)) continue;
        best.runner_up = depth;
        if (depth < best.depth) {
            std::swap(best.depth, best.runner_up);
            best.disc = static_cast<std::int32_t>(d);
        }
    }
    return best;
}

std::vector<DiscHit> DiscOracle::picture(const std::vector<Disc>& discs, double margin) const
{
    std::vector<DiscHit> pixels;
    pixels.reserve(static_cast<std::size_t>(view_.width) * static_cast<std::size_t>(view_.height));
    for (int y = 0; y < view_.height; ++y)
        for (int x = 0; x < view_.width; ++x) pixels.push_back(cast(discs, x + 0.5, y + 0.5, margin));
    return pixels;
}

}  // namespace pcm::test
