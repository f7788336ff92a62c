#include "pcm/cloud/polygon.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

// > 0: c is to the left of the line from a to b.
double turn(const Vec2d& a, const Vec2d& b, const Vec2d& c)
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// The convex hull, counter-clockwise.
std::vector<Vec2d> hull_of(std::vector<Vec2d> points)
{
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    std::vector<Vec2d> hull;
    for (const int side : {0, 1}) {
        const std::size_t begin = hull.size();
        for (const Vec2d& p : points) {
            while (hull.size() >= begin + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        if (side == 0) std::reverse(points.begin(), points.end());
    }
    return hull;
}

// Whether all points are farther than `margin` on the side of the line through a to which (-normal) points.
template <class Points>
bool all_beyond(const Points& points, const Vec2d& a, const Vec2d& normal, double margin)
{
    const double limit = margin * std::hypot(normal[0], normal[1]);
    for (const Vec2d& p : points) {
        const double x = (p[0] - a[0]) * normal[0], y = (p[1] - a[1]) * normal[1];
        // The rounding errors of the products are within the margin of points that are not exact.
        if (!(x + y < -limit - 1e-15 * (std::fabs(x) + std::fabs(y)))) return false;
    }
    return !points.empty();
}

}  // namespace

Polygon::Polygon(std::vector<Vec2d> corners) : corners_(std::move(corners)), min_(corners_.at(0)), max_(min_)
{
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Vec2d &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
        for (std::size_t k = 0; k < 2; ++k) {
            min_[k] = std::min(min_[k], a[k]);
            max_[k] = std::max(max_[k], a[k]);
        }
        edges_.push_back(a[1] <= b[1] ? Edge{a, b} : Edge{b, a});
    }
    std::size_t bands = std::min<std::size_t>(edges_.size(), 4096);
    while (choose_bands(bands) > 8 * edges_.size() + 64 && bands > 1) bands /= 2;
    first_.assign(bands_ + 1, 0);
    const auto for_each_band = [&](const auto& visit) {
        for (std::size_t e = 0; e < edges_.size(); ++e)
            for (std::size_t b = band_of(edges_[e].low[1]); b <= band_of(edges_[e].high[1]); ++b) visit(e, b);
    };
    for_each_band([&](std::size_t, std::size_t band) { ++first_[band + 1]; });
    for (std::size_t b = 0; b < bands_; ++b) first_[b + 1] += first_[b];
    in_bands_.resize(first_[bands_]);
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for_each_band([&](std::size_t e, std::size_t band) { in_bands_[next[band]++] = static_cast<std::uint32_t>(e); });
}

// Monotonic, so an edge is in the band of each y from its low to its high end.
std::size_t Polygon::band_of(double y) const
{
    const double band = (y - min_[1]) * bands_per_length_;
    if (!(band > 0)) return 0;
    return std::min(bands_ - 1, static_cast<std::size_t>(std::min(band, 1e9)));
}

// The number of edges in all bands, when the polygon is divided into this number of bands.
std::size_t Polygon::choose_bands(std::size_t bands)
{
    const double height = max_[1] - min_[1], rate = static_cast<double>(bands) / height;
    const bool divisible = height > 0 && std::isfinite(rate);
    bands_ = divisible ? bands : 1;
    bands_per_length_ = divisible ? rate : 0;
    std::size_t edges = 0;
    for (const Edge& edge : edges_) edges += band_of(edge.high[1]) - band_of(edge.low[1]) + 1;
    return edges;
}

bool Polygon::contains(double x, double y) const
{
    if (!(x >= min_[0] && x <= max_[0] && y >= min_[1] && y <= max_[1])) return false;
    const std::size_t band = band_of(y);
    bool inside = false;
    for (std::size_t i = first_[band]; i < first_[band + 1]; ++i) {
        const Edge& edge = edges_[in_bands_[i]];
        if (edge.low[1] <= y && y < edge.high[1] && turn(edge.low, edge.high, {x, y}) > 0) inside = !inside;
    }
    return inside;
}

bool Polygon::border_touches(const std::vector<Vec2d>& points, double margin) const
{
    const std::vector<Vec2d> hull = hull_of(points);
    Vec2d low = hull.at(0), high = low;
    for (const Vec2d& p : hull)
        for (std::size_t k = 0; k < 2; ++k) {
            if (!std::isfinite(p[k])) return true;
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    for (std::size_t k = 0; k < 2; ++k) {
        low[k] = std::nextafter(low[k] - margin, -HUGE_VAL);
        high[k] = std::nextafter(high[k] + margin, HUGE_VAL);
        if (low[k] > max_[k] || high[k] < min_[k]) return false;
    }
    const auto separate = [&](const Edge& edge) {
        if (edge.high[1] < low[1] || edge.low[1] > high[1] || std::max(edge.low[0], edge.high[0]) < low[0] ||
            std::min(edge.low[0], edge.high[0]) > high[0])
            return true;
        const Vec2d across{edge.high[1] - edge.low[1], edge.low[0] - edge.high[0]};
        if (all_beyond(hull, edge.low, across, margin) || all_beyond(hull, edge.low, {-across[0], -across[1]}, margin))
            return true;
        const std::array<Vec2d, 2> ends{edge.low, edge.high};
        for (std::size_t i = 0; i < hull.size(); ++i) {
            const Vec2d &a = hull[i], &b = hull[(i + 1) % hull.size()];
            if (all_beyond(ends, a, {a[1] - b[1], b[0] - a[0]}, margin)) return true;
        }
        return false;
    };
    const std::size_t from = band_of(low[1]), to = band_of(high[1]);
    for (std::size_t band = from; band <= to; ++band)
        for (std::size_t i = first_[band]; i < first_[band + 1]; ++i) {
            const Edge& edge = edges_[in_bands_[i]];
            if (band == std::max(from, band_of(edge.low[1])) && !separate(edge)) return true;
        }
    return false;
}

}  // namespace pcm
