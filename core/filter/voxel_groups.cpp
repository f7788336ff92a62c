#include "pcm/filter/voxel_groups.h"

#include "pcm/filter/compensated_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pcm {
namespace {

constexpr unsigned radix_bits = 11;
constexpr std::size_t radix = std::size_t(1) << radix_bits;

unsigned bits_of(std::uint64_t number)
{
    unsigned bits = 0;
    for (; number; number >>= 1) ++bits;
    return bits;
}

// Numbers of voxels, counted from the box of the points.
struct VoxelBox {
    Vec3d least{0, 0, 0};
    std::array<unsigned, 3> bits{0, 0, 0};
    unsigned all_bits = 0;

    VoxelBox(const Positions& points, const VoxelLattice& lattice)
    {
        for (std::size_t a = 0; a < 3; ++a) {
            const auto [low, high] = std::minmax_element(points[a].begin(), points[a].end());
            least[a] = lattice.number(*low, a);
            bits[a] = bits_of(static_cast<std::uint64_t>(lattice.number(*high, a) - least[a]));
            all_bits += bits[a];
        }
    }
};

// Sorts by the bits from `low` on. The order of equal ones stays.
void radix_sort(VoxelSort& scratch, unsigned low, unsigned bits)
{
    const std::size_t count = scratch.keys.size(), passes = (bits + radix_bits - 1) / radix_bits;
    scratch.other.resize(count);
    scratch.places.assign(passes * radix, 0);
    for (const std::uint64_t key : scratch.keys)
        for (std::size_t p = 0; p < passes; ++p)
            ++scratch.places[p * radix + ((key >> (low + p * radix_bits)) & (radix - 1))];
    for (std::size_t p = 0; p < passes; ++p) {
        std::size_t* const places = scratch.places.data() + p * radix;
        const unsigned shift = low + static_cast<unsigned>(p) * radix_bits;
        if (places[(scratch.keys[0] >> shift) & (radix - 1)] == count) continue;  // all are equal
        std::exclusive_scan(places, places + radix, places, std::size_t(0));
        for (const std::uint64_t key : scratch.keys) scratch.other[places[(key >> shift) & (radix - 1)]++] = key;
        scratch.keys.swap(scratch.other);
    }
}

// Keys of the voxel's number above the point's number.
void group_by_keys(const Positions& points, const VoxelLattice& lattice, const VoxelBox& box, unsigned index_bits,
                   VoxelSort& scratch, PointGroups& groups)
{
    const std::size_t count = points[0].size();
    scratch.keys.resize(count);
    const unsigned y_at = index_bits + box.bits[0], z_at = y_at + box.bits[1];
    for (std::size_t i = 0; i < count; ++i) {
        const auto number = [&](std::size_t a) {
            return static_cast<std::uint64_t>(
                static_cast<std::int64_t>(lattice.number(points[a][i], a) - box.least[a]));
        };
        // A shift by 64 is only ever one of 0.
        scratch.keys[i] = i | number(0) << index_bits | number(1) << (y_at & 63) | number(2) << (z_at & 63);
    }
    radix_sort(scratch, index_bits, box.all_bits);
    const std::uint64_t mask = (std::uint64_t(1) << index_bits) - 1;
    groups.order.resize(count);
    std::uint64_t voxel = ~scratch.keys[0];
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t key = scratch.keys[i];
        groups.order[i] = static_cast<std::uint32_t>(key & mask);
        if ((key ^ voxel) & ~mask) groups.begins.push_back(static_cast<std::uint32_t>(i));
        voxel = key;
    }
}

void group_by_comparisons(const Positions& points, const VoxelLattice& lattice, PointGroups& groups)
{
    groups.order.resize(points[0].size());
    std::iota(groups.order.begin(), groups.order.end(), 0u);
    std::array<std::vector<double>, 3> numbers;
    for (std::size_t a = 0; a < 3; ++a)
        for (const double x : points[a]) numbers[a].push_back(lattice.number(x, a));
    const auto voxel = [&](std::uint32_t i) { return std::array{numbers[2][i], numbers[1][i], numbers[0][i]}; };
    std::stable_sort(groups.order.begin(), groups.order.end(),
                     [&](std::uint32_t i, std::uint32_t j) { return voxel(i) < voxel(j); });
    for (std::size_t i = 0; i < groups.order.size(); ++i)
        if (i == 0 || voxel(groups.order[i]) != voxel(groups.order[i - 1]))
            groups.begins.push_back(static_cast<std::uint32_t>(i));
}

}  // namespace

void group_by_voxel(const Positions& points, const VoxelLattice& lattice, VoxelSort& scratch, PointGroups& groups)
{
    groups.order.clear();
    groups.begins.clear();
    if (points[0].empty()) return;
    const VoxelBox box(points, lattice);
    const unsigned index_bits = bits_of(points[0].size() - 1);
    if (box.all_bits + index_bits <= 64)
        group_by_keys(points, lattice, box, index_bits, scratch, groups);
    else
        group_by_comparisons(points, lattice, groups);
    groups.begins.push_back(static_cast<std::uint32_t>(groups.order.size()));
}

double kept_in_voxel(double mean, double inside, const VoxelLattice& lattice, std::size_t axis)
{
    const double number = lattice.number(inside, axis);
    while (lattice.number(mean, axis) != number) mean = std::nextafter(mean, inside);
    return mean;
}

Positions centroids(const Positions& points, const VoxelLattice& lattice, const PointGroups& groups)
{
    Positions result;
    for (std::vector<double>& axis : result) axis.resize(groups.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const std::uint32_t* const order = groups.order.data() + groups.begins[g];
        const std::size_t count = groups.points_of(g);
        Vec3d first;
        for (std::size_t a = 0; a < 3; ++a) first[a] = points[a][order[0]];
        if (count == 1) {
            for (std::size_t a = 0; a < 3; ++a) result[a][g] = first[a];
            continue;
        }
        std::array<CompensatedSum, 3> sums;
        for (std::size_t i = 1; i < count; ++i)
            for (std::size_t a = 0; a < 3; ++a) sums[a].add(points[a][order[i]] - first[a]);
        for (std::size_t a = 0; a < 3; ++a)
            result[a][g] = kept_in_voxel(first[a] + sums[a].value() / static_cast<double>(count), first[a], lattice, a);
    }
    return result;
}

std::vector<std::uint32_t> nearest_to(const Positions& centroids, const Positions& points, const PointGroups& groups)
{
    std::vector<std::uint32_t> result(groups.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = groups.begins[g]; i < groups.begins[g + 1]; ++i) {
            const std::uint32_t point = groups.order[i];
            double square = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const double d = points[a][point] - centroids[a][g];
                square += d * d;
            }
            if (square < least || i == groups.begins[g]) {
                least = square;
                result[g] = point;
            }
        }
    }
    return result;
}

}  // namespace pcm
