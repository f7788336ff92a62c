// Positions to search, and the comparison with all pairs.
#pragma once

#include "pcm/knn/unit_search.h"

#include <cmath>
#include <functional>
#include <random>

namespace pcm::search_clouds {

// Narrow positions; size times what `place` returns.
inline SearchPositions narrow(std::size_t size, const std::function<Vec3i(std::size_t)>& place, Vec3d scale = {1, 1, 1})
{
    SearchPositions p;
    p.scale = scale;
    for (auto& axis : p.narrow) axis.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
        const Vec3i at = place(i);
        for (std::size_t axis = 0; axis < 3; ++axis) p.narrow[axis][i] = static_cast<std::int32_t>(at[axis]);
    }
    return p;
}

inline SearchPositions wide(std::size_t size, const std::function<Vec3i(std::size_t)>& place, Vec3d scale = {1, 1, 1})
{
    SearchPositions p;
    p.scale = scale;
    for (auto& axis : p.wide) axis.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
        const Vec3i at = place(i);
        for (std::size_t axis = 0; axis < 3; ++axis) p.wide[axis][i] = at[axis];
    }
    return p;
}

// Places in a box with sides 2 * half + 1 about the origin, the same ones in each run.
class InBox {
public:
    InBox(std::int64_t hx, std::int64_t hy, std::int64_t hz, unsigned seed = 1) : half_{hx, hy, hz}, random_(seed) {}
    Vec3i operator()(std::size_t = 0)
    {
        Vec3i at;
        for (std::size_t axis = 0; axis < 3; ++axis)
            at[axis] = std::uniform_int_distribution<std::int64_t>(-half_[axis], half_[axis])(random_);
        return at;
    }

private:
    Vec3i half_;
    std::mt19937_64 random_;
};

inline double squared_of(const SearchPositions& p, std::uint32_t a, std::uint32_t b)
{
    double d[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t steps =
            p.is_wide() ? p.wide[axis][b] - p.wide[axis][a] : std::int64_t(p.narrow[axis][b]) - p.narrow[axis][a];
        d[axis] = static_cast<double>(steps) * p.scale[axis];
    }
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

// The squares of the nearest k, ascending, within max_distance.
std::vector<double> all_pairs(const SearchPositions& p, std::uint32_t query, const UnitSearchOptions& options);

struct Comparison {
    std::size_t queries = 0;    // handed out
    std::string first_mistake;  // empty: none
};

// The same with a search that was made of the positions.
Comparison compare(const UnitSearch& search, const SearchPositions& p, const UnitSearchOptions& options,
                   const std::vector<std::uint32_t>* queries, std::size_t stride);

// Searches and compares each of `queries` (all when null) with all pairs, or only every `stride`-th of them.
Comparison compare(const SearchPositions& p, const UnitSearchOptions& options,
                   const std::vector<std::uint32_t>* queries = nullptr, std::size_t stride = 1);

}  // namespace pcm::search_clouds
