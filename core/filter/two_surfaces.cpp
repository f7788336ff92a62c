#include "pcm/filter/two_surfaces.h"

#include "pcm/filter/lane_sum.h"

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

// Least-squares fit of one function by six others.
class Regression {
public:
    static constexpr std::size_t N = 6;
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

// The points relative to their centroid: along the normal, and by two coordinates across it.
struct Heights {
    std::array<double, most_surface_points> up, across, along;
    std::array<double, most_surface_points> above;  // 1: of the upper sheet; else 0
    std::size_t count = 0;
    Vec3d centre{};  // centroid, relative to the point

    bool has_two_sheets() const
    {
        constexpr auto least = static_cast<double>(least_of_a_sheet);
        const double upper = lane_sum(count, [&](std::size_t j) { return above[j]; });
        return upper >= least && static_cast<double>(count) - upper >= least;
    }
    // Sets f(d) for each point, d being its place relative to the centroid: each neighbour, and the point itself last.
    template <class F>
    void set(std::array<double, most_surface_points>& values, const OnePointsNeighbours& n, const F& f) const
    {
        for (std::size_t j = 0; j + 1 < count; ++j)
            values[j] = f(n.dx[j] - centre[0], n.dy[j] - centre[1], n.dz[j] - centre[2]);
        values[count - 1] = f(-centre[0], -centre[1], -centre[2]);
    }
};

auto component_along(const Vec3d& axis)
{
    return [axis](double x, double y, double z) { return x * axis[0] + y * axis[1] + z * axis[2]; };
}

// Without `across`, `along` and `above`.
Heights heights_of(const OnePointsNeighbours& n, const Vec3d& normal)
{
    Heights h;
    h.count = std::min(n.count + 1, most_surface_points);
    for (std::size_t a = 0; a < 3; ++a) {
        const double* const d = a == 0 ? n.dx : a == 1 ? n.dy : n.dz;
        h.centre[a] = lane_sum(h.count - 1, [&](std::size_t j) { return d[j]; }) / static_cast<double>(h.count);
    }
    h.set(h.up, n, component_along(normal));
    return h;
}

// Whether the heights above 0 and the others are far apart compared with what is in them; a quick rejection.
bool may_be_two(const Heights& h)
{
    const auto is_up = [&](std::size_t j) { return h.up[j] > 0 ? 1.0 : 0.0; };
    const double upper = lane_sum(h.count, is_up), all = static_cast<double>(h.count), lower = all - upper;
    constexpr auto least = static_cast<double>(least_of_a_sheet);
    if (upper < least || lower < least) return false;
    const double sum = lane_sum(h.count, [&](std::size_t j) { return h.up[j] > 0 ? h.up[j] : 0.0; });
    const double squares = lane_sum(h.count, [&](std::size_t j) { return h.up[j] * h.up[j]; });
    const double gap = sum / upper + sum / lower;  // the sum of all heights is 0
    const double within = squares / all - gap * gap * upper * lower / (all * all);
    return gap * gap > clear_at_first * clear_at_first * std::max(0.0, within);
}

// Makes values that are 0 in the mean independent of `axis`, which has a length of 1, or is 0.
void remove(std::array<double, most_surface_points>& values, const std::array<double, most_surface_points>& axis,
            std::size_t count)
{
    const double share = lane_sum(count, [&](std::size_t j) { return values[j] * axis[j]; });
    for (std::size_t j = 0; j < count; ++j) values[j] -= share * axis[j];
}

// Sets `above` by the heights, and `across` and `along`, as functions of the points, to ones of length 1 at right
// angles to each other, or 0 where the points have no such extent. Makes the heights independent of both: those over
// the plane that fits all points best.
void spread_out(Heights& h, const OnePointsNeighbours& n, const Vec3d& normal)
{
    for (std::size_t j = 0; j < h.count; ++j) h.above[j] = h.up[j] > 0 ? 1 : 0;
    std::size_t least = 0;
    for (std::size_t a = 1; a < 3; ++a)
        if (std::fabs(normal[a]) < std::fabs(normal[least])) least = a;
    Vec3d axis{};
    axis[least] = 1;
    const Vec3d first = normalised(cross(normal, axis));
    h.set(h.across, n, component_along(first));
    h.set(h.along, n, component_along(cross(normal, first)));
    const auto squares_of = [&](const auto& values) {
        return lane_sum(h.count, [&](std::size_t j) { return values[j] * values[j]; });
    };
    const double extent = squares_of(h.across) + squares_of(h.along);
    const auto normalise = [&](auto& values) {
        const double squares = squares_of(values), factor = squares > 1e-9 * extent ? 1 / std::sqrt(squares) : 0;
        for (std::size_t j = 0; j < h.count; ++j) values[j] *= factor;
    };
    normalise(h.across);
    remove(h.along, h.across, h.count);
    normalise(h.along);
    remove(h.up, h.across, h.count);
    remove(h.up, h.along, h.count);
}

// Two parallel planes, fitted twice: each point goes to the nearer one. The gap; 0 where there are no two sheets.
// Least squares of the heights by `above`, relative to its own fit by 1, `across` and `along`, which are at right
// angles to each other.
double gap_of(Heights& h)
{
    const double all = static_cast<double>(h.count);
    const double heights = lane_sum(h.count, [&](std::size_t j) { return h.up[j] * h.up[j]; });
    for (int round = 0;; ++round) {
        if (!h.has_two_sheets()) return 0;
        const auto above_times = [&](const auto& values) {
            return lane_sum(h.count, [&](std::size_t j) { return h.above[j] * values[j]; });
        };
        const double upper = above_times(h.above), mean = upper / all;
        const double across = above_times(h.across), along = above_times(h.along);
        const double rest = upper - upper * mean - across * across - along * along;  // sum of squares
        const double gap = rest > 1e-9 * upper ? above_times(h.up) / rest : 0;
        if (round == 2) {
            const double squares = std::max(0.0, heights - gap * gap * rest), freedom = all - 4;
            return gap * gap > clear_gap * clear_gap * squares / freedom ? gap : 0;
        }
        for (std::size_t j = 0; j < h.count; ++j) {
            const double over = h.up[j] + gap * (mean + across * h.across[j] + along * h.along[j]);
            h.above[j] = over > gap / 2 ? 1 : 0;
        }
    }
}

// The share of the variance of `above` that a quadratic function of the place explains.
double explained_by_place(const Heights& h)
{
    Regression places;
    const auto terms = [&](std::size_t j) {
        const double x = h.across[j], y = h.along[j];
        return std::array<double, 6>{1, x, y, x * x, x * y, y * y};
    };
    for (std::size_t j = 0; j < h.count; ++j) places.add(terms(j), h.above[j]);
    const std::array<double, 6> f = places.solve();
    const double mean = lane_sum(h.count, [&](std::size_t j) { return h.above[j]; }) / static_cast<double>(h.count);
    double left = 0;
    for (std::size_t j = 0; j < h.count; ++j) {
        const std::array<double, 6> x = terms(j);
        double rest = h.above[j];
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
