#include "pcm/filter/two_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace pcm {
namespace {

constexpr std::size_t least_neighbours = 9,
                      most_surface_points = 65;  // further neighbours do not show what touches here
constexpr std::size_t least_of_a_sheet = 3;
// The gap over the root mean square of the distances from the sheets: at first, when both may still be tilted together,
// and at last. One sheet with heights of a normal distribution has 2.7 when it is cut in two, with uniform ones 3.5.
constexpr double clear_at_first = 3.6, clear_gap = 6;
// How much of where the upper points are a function of place explains: more than this is a step or a curved surface.
constexpr double most_explained = 0.8;

// Least-squares fit of one function by N others.
template <std::size_t N>
class Regression {
public:
    void add(const std::array<double, N>& x, double y)
    {
        for (std::size_t i = 0; i < N; ++i) {
            right_[i] += x[i] * y;
            for (std::size_t j = 0; j <= i; ++j) left_[i][j] += x[i] * x[j];
        }
    }
    // The factors; 0 for a function that the ones before it explain already.
    std::array<double, N> solve()
    {
        std::array<double, N> diagonal;
        for (std::size_t i = 0; i < N; ++i) {
            diagonal[i] = left_[i][i];
            for (std::size_t j = 0; j < i; ++j) {
                for (std::size_t k = 0; k < j; ++k) left_[i][j] -= left_[i][k] * left_[j][k] * left_[k][k];
                left_[i][j] = left_[j][j] > 0 ? left_[i][j] / left_[j][j] : 0;
            }
            for (std::size_t j = 0; j < i; ++j) {
                left_[i][i] -= left_[i][j] * left_[i][j] * left_[j][j];
                right_[i] -= left_[i][j] * right_[j];
            }
            if (!(left_[i][i] > 1e-9 * diagonal[i])) left_[i][i] = 0;
        }
        std::array<double, N> factors{};
        for (std::size_t i = N; i-- > 0;) {
            if (left_[i][i] == 0) continue;
            factors[i] = right_[i] / left_[i][i];
            for (std::size_t j = i + 1; j < N; ++j) factors[i] -= left_[j][i] * factors[j];
        }
        return factors;
    }

private:
    std::array<std::array<double, N>, N> left_{};  // below the diagonal; L D L^T once solved
    std::array<double, N> right_{};
};

// The points relative to their centroid: along the normal, and across it in units of their spread.
struct Heights {
    std::array<double, most_surface_points> up, across, along;
    std::array<bool, most_surface_points> above;
    std::size_t count = 0;
    Vec3d centre{};  // centroid, relative to the point

    std::size_t upper() const
    {
        return static_cast<std::size_t>(
            std::count(above.begin(), above.begin() + static_cast<std::ptrdiff_t>(count), true));
    }
    bool has_two_sheets() const { return upper() >= least_of_a_sheet && count - upper() >= least_of_a_sheet; }
};

// The neighbour j, after all neighbours the point itself, relative to the centroid.
Vec3d place_of(const OnePointsNeighbours& n, const Heights& h, std::size_t j)
{
    return (j + 1 < h.count ? Vec3d{n.dx[j], n.dy[j], n.dz[j]} : Vec3d{}) - h.centre;
}

// Without `across` and `along`.
Heights heights_of(const OnePointsNeighbours& n, const Vec3d& normal)
{
    Heights h;
    h.count = std::min(n.count + 1, most_surface_points);
    for (std::size_t j = 0; j + 1 < h.count; ++j) h.centre = h.centre + Vec3d{n.dx[j], n.dy[j], n.dz[j]};
    h.centre = h.centre / static_cast<double>(h.count);
    for (std::size_t j = 0; j < h.count; ++j) {
        h.up[j] = dot(place_of(n, h, j), normal);
        h.above[j] = h.up[j] > 0;
    }
    return h;
}

// Sets `across` and `along`.
void spread_out(Heights& h, const OnePointsNeighbours& n, const Vec3d& normal)
{
    std::size_t least = 0;
    for (std::size_t a = 1; a < 3; ++a)
        if (std::fabs(normal[a]) < std::fabs(normal[least])) least = a;
    Vec3d axis{};
    axis[least] = 1;
    const Vec3d first = normalised(cross(normal, axis)), second = cross(normal, first);
    double squares = 0;
    for (std::size_t j = 0; j < h.count; ++j) {
        const Vec3d d = place_of(n, h, j);
        h.across[j] = dot(d, first);
        h.along[j] = dot(d, second);
        squares += h.across[j] * h.across[j] + h.along[j] * h.along[j];
    }
    const double spread = std::sqrt(squares / static_cast<double>(h.count));
    for (std::size_t j = 0; j < h.count && spread > 0; ++j) h.across[j] /= spread, h.along[j] /= spread;
}

// Whether the upper and the lower half are far apart compared with what is in them; a quick rejection.
bool may_be_two(const Heights& h)
{
    if (!h.has_two_sheets()) return false;
    double sum[2] = {}, squares = 0;
    for (std::size_t j = 0; j < h.count; ++j) {
        sum[h.above[j]] += h.up[j];
        squares += h.up[j] * h.up[j];
    }
    const double upper = static_cast<double>(h.upper()), all = static_cast<double>(h.count), lower = all - upper;
    const double gap = sum[1] / upper - sum[0] / lower;
    const double within = squares / all - gap * gap * upper * lower / (all * all);
    return gap * gap > clear_at_first * clear_at_first * std::max(0.0, within);
}

// Two parallel planes, fitted twice: each point goes to the nearer one. The gap; 0 where there are no two sheets.
double gap_of(Heights& h)
{
    for (int round = 0;; ++round) {
        if (!h.has_two_sheets()) return 0;
        Regression<4> planes;
        for (std::size_t j = 0; j < h.count; ++j)
            planes.add({1, h.across[j], h.along[j], h.above[j] ? 1.0 : 0}, h.up[j]);
        const std::array<double, 4> f = planes.solve();
        const double gap = f[3];
        double squares = 0;
        for (std::size_t j = 0; j < h.count; ++j) {
            const double over = h.up[j] - (f[0] + f[1] * h.across[j] + f[2] * h.along[j]);
            const double rest = over - (h.above[j] ? gap : 0);
            squares += rest * rest;
            if (round < 2) h.above[j] = over > gap / 2;
        }
        if (round < 2) continue;
        const double freedom = static_cast<double>(h.count - 4);
        return gap * gap > clear_gap * clear_gap * squares / freedom ? gap : 0;
    }
}

// The share of the variance of `above` that a quadratic function of the place explains.
double explained_by_place(const Heights& h)
{
    Regression<6> places;
    const auto terms = [&](std::size_t j) {
        const double x = h.across[j], y = h.along[j];
        return std::array<double, 6>{1, x, y, x * x, x * y, y * y};
    };
    for (std::size_t j = 0; j < h.count; ++j) places.add(terms(j), h.above[j] ? 1 : 0);
    const std::array<double, 6> f = places.solve();
    const double mean = static_cast<double>(h.upper()) / static_cast<double>(h.count);
    double left = 0;
    for (std::size_t j = 0; j < h.count; ++j) {
        const std::array<double, 6> x = terms(j);
        double rest = h.above[j] ? 1 : 0;
        for (std::size_t i = 0; i < x.size(); ++i) rest -= f[i] * x[i];
        left += rest * rest;
    }
    return 1 - left / (static_cast<double>(h.count) * mean * (1 - mean));
}

}  // namespace

bool are_two_surfaces(const OnePointsNeighbours& neighbours, const Vec3d& normal, double least_gap)
{
    if (neighbours.count < least_neighbours) return false;
    Heights heights = heights_of(neighbours, normal);
    if (!may_be_two(heights)) return false;
    spread_out(heights, neighbours, normal);
    const double gap = gap_of(heights);
    return gap > least_gap && explained_by_place(heights) <= most_explained;
}

}  // namespace pcm
