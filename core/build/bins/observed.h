// Statistics of the points of a cloud, taken while they are read.
#pragma once

#include "pcm/cloud/geometry.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace pcm {

struct Observed {
    std::uint64_t points = 0;
    std::uint64_t hash = 0;
    double position_error = 0;
    std::array<Vec3i, 6> extremes{};

    // Ties go to the smallest point, so that the result does not depend on the order.
    void see(const Vec3i& p)
    {
        for (std::size_t a = 0; a < 3; ++a) {
            if (points == 0 || p[a] < extremes[2 * a][a] || (p[a] == extremes[2 * a][a] && p < extremes[2 * a]))
                extremes[2 * a] = p;
            if (points == 0 || p[a] > extremes[2 * a + 1][a] ||
                (p[a] == extremes[2 * a + 1][a] && p < extremes[2 * a + 1]))
                extremes[2 * a + 1] = p;
        }
        ++points;
    }
    // The same for many points, given as columns: few of a batch are extremes.
    template <class Columns>
    void see(const Columns& xyz, std::size_t count)
    {
        if (count == 0) return;
        const auto point = [&](std::size_t i) { return Vec3i{xyz[0][i], xyz[1][i], xyz[2][i]}; };
        if (points == 0) extremes.fill(point(0));
        for (std::size_t a = 0; a < 3; ++a) {
            const auto* column = xyz[a].data();
            auto low = column[0], high = low;
            for (std::size_t i = 1; i < count; ++i) {
                low = std::min(low, column[i]);
                high = std::max(high, column[i]);
            }
            Vec3i &least = extremes[2 * a], &most = extremes[2 * a + 1];
            for (std::size_t i = 0; i < count && low <= least[a]; ++i)
                if (column[i] == low && (low < least[a] || point(i) < least)) least = point(i);
            for (std::size_t i = 0; i < count && high >= most[a]; ++i)
                if (column[i] == high && (high > most[a] || point(i) < most)) most = point(i);
        }
        points += count;
    }
    void merge(const Observed& other)
    {
        if (other.points == 0) return;
        for (std::size_t k = 0; k < 6; ++k) {
            const std::size_t a = k / 2;
            const Vec3i &p = other.extremes[k], &q = extremes[k];
            const bool beyond = k % 2 ? p[a] > q[a] : p[a] < q[a];
            if (points == 0 || beyond || (p[a] == q[a] && p < q)) extremes[k] = p;
        }
        points += other.points;
        hash += other.hash;
        position_error = std::max(position_error, other.position_error);
    }
};

}  // namespace pcm
