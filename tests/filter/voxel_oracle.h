// The voxel grid of a cloud in memory, by a map of its voxels: slow, simple, in long double.
#pragma once

#include "pcm/filter/voxel_lattice.h"
#include "pcm/tree/tree_reader.h"
#include "tests/memory_reader.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace pcm::test {

using Voxel = std::array<std::int64_t, 3>;

inline Voxel voxel_of(const VoxelLattice& lattice, const Vec3d& p)
{
    Voxel voxel;
    for (std::size_t a = 0; a < 3; ++a)
        voxel[a] = static_cast<std::int64_t>(std::floor((p[a] - lattice.anchor[a]) / lattice.size));
    return voxel;
}

// The numbers of the points in each voxel.
inline std::map<Voxel, std::vector<std::size_t>> voxels_of(const MemoryCloud& cloud, const VoxelLattice& lattice)
{
    std::map<Voxel, std::vector<std::size_t>> voxels;
    for (std::size_t i = 0; i < cloud.points.size; ++i)
        voxels[voxel_of(lattice, position_of(cloud.points, cloud.info.grid, i))].push_back(i);
    return voxels;
}

inline long double mean_position(const MemoryCloud& cloud, const std::vector<std::size_t>& points, std::size_t axis)
{
    long double sum = 0;
    const double first = position_of(cloud.points, cloud.info.grid, points[0])[axis];
    for (const std::size_t i : points)
        sum += static_cast<long double>(position_of(cloud.points, cloud.info.grid, i)[axis]) - first;
    return first + sum / static_cast<long double>(points.size());
}

inline Schema all_types()
{
    Schema schema;
    const ScalarType types[] = {ScalarType::i8,  ScalarType::u8,  ScalarType::i16, ScalarType::u16, ScalarType::i32,
                                ScalarType::u32, ScalarType::i64, ScalarType::u64, ScalarType::f32, ScalarType::f64};
    for (const ScalarType type : types) schema.add({"a_" + std::string(name_of(type)), type, 1, 1, 0, {}});
    schema.add({"rgb", ScalarType::u16, 3, 1, 0, {}});
    schema.add({"scan_angle", ScalarType::i16, 1, 0.006, 2, {}});
    schema.add({"classification", ScalarType::u8, 1, 1, 0, {}});
    schema.add({"point_source_id", ScalarType::u16, 1, 1, 0, {}});
    schema.add({"scan", ScalarType::i32, 1, 1, 0, {}});
    schema.add({"normal", ScalarType::f32, 3, 1, 0, {}});
    schema.add({"gps_time", ScalarType::f64, 1, 1, 0, {}});
    return schema;
}

inline MemoryCloud points_of(std::shared_ptr<const Tree> tree)
{
    TreeReader reader(std::move(tree), std::nullopt, {});
    return read_all(reader, 10000);
}

// Few different values in the columns of categories, so that there are majorities.
inline void make_categories(MemoryCloud& cloud)
{
    for (std::size_t k = 0; k < cloud.info.schema.size(); ++k) {
        Column& column = cloud.points.attributes[k];
        for (std::size_t i = 0; i < cloud.points.size; ++i) {
            if (cloud.info.schema[k].name == "classification") column.as<std::uint8_t>()[i] %= 3;
            if (cloud.info.schema[k].name == "point_source_id") column.as<std::uint16_t>()[i] %= 5;
            if (cloud.info.schema[k].name == "scan") column.as<std::int32_t>()[i] %= 2;  // -1, 0, 1
        }
    }
}

inline long double raw(const Column& column, std::size_t point, std::uint32_t component)
{
    const std::size_t i = point * column.components() + component;
    if (column.type() == ScalarType::i64) return static_cast<long double>(column.as<std::int64_t>()[i]);
    if (column.type() == ScalarType::u64) return static_cast<long double>(column.as<std::uint64_t>()[i]);
    return column.value(point, component);
}

inline void expect_combined(const Attribute& attribute, const Column& from, const std::vector<std::size_t>& points,
                            const Column& to, std::size_t at)
{
    for (std::uint32_t c = 0; c < attribute.components; ++c) {
        const long double found = raw(to, at, c);
        if (attribute.name == "classification" || attribute.name == "point_source_id" || attribute.name == "scan") {
            std::map<long double, int> counts;
            for (const std::size_t i : points) ++counts[raw(from, i, c)];
            long double best = 0;
            int most = 0;
            for (const auto& [value, count] : counts)
                if (count > most) most = count, best = value;
            ASSERT_EQ(found, best) << attribute.name;
            continue;
        }
        long double sum = 0, magnitudes = 0;
        for (const std::size_t i : points) {
            sum += raw(from, i, c);
            magnitudes += std::fabs(raw(from, i, c));
        }
        long double mean = sum / static_cast<long double>(points.size());
        if (attribute.name == "normal") {
            long double squares = 0;
            for (std::uint32_t d = 0; d < 3; ++d) {
                long double axis = 0;
                for (const std::size_t i : points) axis += raw(from, i, d);
                squares +=
                    axis / static_cast<long double>(points.size()) * axis / static_cast<long double>(points.size());
            }
            ASSERT_NEAR(static_cast<double>(found), static_cast<double>(mean / std::sqrt(squares)), 1e-5);
        } else if (attribute.type == ScalarType::f32) {
            ASSERT_EQ(static_cast<float>(found), static_cast<float>(mean)) << attribute.name;
        } else if (attribute.type == ScalarType::f64) {
            const double tolerance = static_cast<double>(magnitudes / static_cast<long double>(points.size()));
            ASSERT_NEAR(static_cast<double>(found), static_cast<double>(mean), 3e-16 * tolerance) << attribute.name;
        } else {
            // Halves up, exactly; the smallest number is counted from, so that nothing is negative.
            long double least = raw(from, points[0], c);
            for (const std::size_t i : points) least = std::min(least, raw(from, i, c));
            unsigned __int128 above = 0;
            for (const std::size_t i : points) above += static_cast<std::uint64_t>(raw(from, i, c) - least);
            const auto rounded = static_cast<std::uint64_t>((2 * above + points.size()) / (2 * points.size()));
            ASSERT_EQ(found, least + static_cast<long double>(rounded)) << attribute.name;
        }
    }
}

// Every voxel once, its centroid to half a last bit, its attributes as their kind says, and the counts.
inline void expect_grid(const MemoryCloud& model, const MemoryCloud& found, const VoxelLattice& lattice)
{
    const auto voxels = voxels_of(model, lattice);
    ASSERT_EQ(found.points.size, voxels.size());
    EXPECT_EQ(found.info.position_type, ScalarType::f64);
    std::set<Voxel> seen;
    for (std::size_t g = 0; g < found.points.size; ++g) {
        const Vec3d p = position_of(found.points, found.info.grid, g);
        const auto voxel = voxels.find(voxel_of(lattice, p));
        ASSERT_TRUE(voxel != voxels.end()) << "a centroid outside of the voxels with points";
        ASSERT_TRUE(seen.insert(voxel->first).second) << "two points in a voxel";
        const std::vector<std::size_t>& points = voxel->second;
        for (std::size_t a = 0; a < 3; ++a) {
            const long double mean = mean_position(model, points, a);
            const double bit = std::nextafter(std::fabs(p[a]), 1e300) - std::fabs(p[a]);
            ASSERT_LE(std::fabs(static_cast<long double>(p[a]) - mean), 0.51L * bit + 1e-15L * lattice.size) << a;
        }
        for (std::size_t k = 0; k < model.info.schema.size(); ++k)
            expect_combined(model.info.schema[k], model.points.attributes[k], points, found.points.attributes[k], g);
        ASSERT_EQ(found.points.attributes.back().as<std::uint32_t>()[g], points.size());
    }
}

// Every voxel once, as one of its points that is nearest to the centroid, and the counts.
inline void expect_nearest(const MemoryCloud& model, const MemoryCloud& found, const VoxelLattice& lattice)
{
    const auto voxels = voxels_of(model, lattice);
    ASSERT_EQ(found.points.size, voxels.size());
    for (std::size_t g = 0; g < found.points.size; ++g) {
        const Vec3d p = position_of(found.points, found.info.grid, g);
        const std::vector<std::size_t>& points = voxels.at(voxel_of(lattice, p));
        const auto distance = [&](const Vec3d& q) {
            long double square = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const long double d = q[a] - mean_position(model, points, a);
                square += d * d;
            }
            return static_cast<double>(std::sqrt(square));
        };
        bool is_one = false;
        for (const std::size_t i : points) {
            const Vec3d q = position_of(model.points, model.info.grid, i);
            EXPECT_GE(distance(q), distance(p) - 1e-8);
            bool same = q == p;
            for (std::size_t k = 0; k < model.info.schema.size(); ++k)
                same = same && bytes_of(model.points.attributes[k], i) == bytes_of(found.points.attributes[k], g);
            is_one = is_one || same;
        }
        EXPECT_TRUE(is_one);
        EXPECT_EQ(found.points.attributes.back().as<std::uint32_t>()[g], points.size());
    }
}

}  // namespace pcm::test
