// A tree's points as a plain multiset of rows, against which updates are checked, and clouds to append.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/build/builder.h"
#include "pcm/cloud/selection.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/verify.h"
#include "pcm/tree/verify_levels.h"
#include "pcm/update/append.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pcm::test {

// Grid coordinates and the raw bytes of all attributes.
struct Row {
    Vec3i q;
    std::string attributes;
    bool operator<(const Row& o) const { return q != o.q ? q < o.q : attributes < o.attributes; }
    bool operator==(const Row& o) const { return q == o.q && attributes == o.attributes; }
};

// All points of a tree, sorted.
inline std::vector<Row> rows_of(const Tree& tree)
{
    std::vector<Row> rows;
    for (NodeId id = 0; id < tree.nodes().size(); ++id) {
        const Chunk chunk = tree.read_chunk(id, ColumnSet::all(tree.info().schema));
        for (std::uint32_t i = 0; i < chunk.points; ++i) {
            Row row{chunk.positions->grid(i), {}};
            for (const auto& column : chunk.attributes) row.attributes += bytes_of(*column, i);
            rows.push_back(std::move(row));
        }
    }
    std::sort(rows.begin(), rows.end());
    return rows;
}

// The points of a cloud, rounded to `grid`, in the order of the cloud.
inline std::vector<Row> rows_of(const MemoryCloud& cloud, const Grid& grid)
{
    std::vector<Row> rows;
    for (std::size_t i = 0; i < cloud.points.size; ++i) {
        Row row;
        const Vec3d p = position_of(cloud.points, cloud.info.grid, i);
        for (std::size_t a = 0; a < 3; ++a)
            row.q[a] = static_cast<std::int64_t>(std::llrint((p[a] - grid.offset[a]) / grid.scale[a]));
        for (const Column& column : cloud.points.attributes) row.attributes += bytes_of(column, i);
        rows.push_back(std::move(row));
    }
    return rows;
}

inline void add(std::vector<Row>& rows, std::vector<Row> more)
{
    rows.insert(rows.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
    std::sort(rows.begin(), rows.end());
}

// All checks of a tree; its points must be those of the model.
inline void expect_tree(const std::filesystem::path& path, const std::vector<Row>& rows, const std::string& when)
{
    SCOPED_TRACE(when);
    const auto tree = Tree::open(path);
    EXPECT_EQ(tree->info().points, rows.size());
    const VerifyReport verified = verify_tree(path, 1);
    EXPECT_TRUE(verified.faults.empty()) << verified.faults.front();
    const LevelsReport levels = verify_levels(*tree, 1);
    EXPECT_TRUE(levels.faults.empty()) << levels.faults.front();
    EXPECT_TRUE(rows_of(*tree) == rows) << "the points are others";
    Box3i box;
    for (const Row& row : rows) box.extend(row.q);
    EXPECT_EQ(tree->info().box, box);
    for (std::size_t k = 0; k < 6 && !rows.empty(); ++k) {
        const Row* best = nullptr;  // rows are sorted: the first of equals is the smallest
        for (const Row& row : rows)
            if (row.q[k / 2] == (k % 2 ? box.max : box.min)[k / 2]) {
                best = &row;
                break;
            }
        EXPECT_EQ(tree->info().extremes[k], best->q) << k;
    }
}

inline Schema test_schema()
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    schema.add({"rgb", ScalarType::u8, 3, 1, 0, ""});
    schema.add({"gps_time", ScalarType::f64, 1, 1, 0, ""});
    schema.add({"classification", ScalarType::u8, 1, 1, 0, ""});
    return schema;
}

// Points on a bumpy surface around (x, y), `width` wide, on a grid of 0.01; few classes.
inline MemoryCloud surface(std::size_t count, double x, double y, double width, std::uint64_t seed)
{
    const Grid grid{{0.01, 0.01, 0.01}, {1000, 2000, -50}};
    MemoryCloud cloud = random_cloud(test_schema(), grid, count, seed);
    std::mt19937_64 random(seed + 1);
    for (std::size_t i = 0; i < count; ++i) {
        const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
        const double u = x + width * unit(), v = y + width * unit();
        cloud.points.grid_xyz[0][i] = static_cast<std::int32_t>(u * 100);
        cloud.points.grid_xyz[1][i] = static_cast<std::int32_t>(v * 100);
        cloud.points.grid_xyz[2][i] =
            static_cast<std::int32_t>(300 * std::sin(u / 7) + 200 * std::cos(v / 5) + 20 * unit());
        cloud.points.attributes[3].as<std::uint8_t>()[i] = static_cast<std::uint8_t>(random() % 8);
    }
    return cloud;
}

inline BuildOptions small_build(Sampling sampling = Sampling::poisson)
{
    BuildOptions options;
    options.memory_bytes = 64 << 20;
    options.chunk_points = 1000;
    options.threads = 2;
    options.sampling = sampling;
    return options;
}

inline void build(const MemoryCloud& cloud, const std::filesystem::path& path, Sampling sampling = Sampling::poisson)
{
    MemoryReader reader(cloud);
    BuildOptions options = small_build(sampling);
    options.overwrite = true;
    build_tree(reader, {"first.las"}, path, options);
}

inline AppendOptions small_append(unsigned threads = 2)
{
    AppendOptions options;
    options.memory_bytes = 64 << 20;
    options.chunk_points = 1000;
    options.threads = threads;
    return options;
}

inline AppendReport append(const std::filesystem::path& path, const MemoryCloud& cloud,
                           const AppendOptions& options = small_append())
{
    MemoryReader reader(cloud);
    return append_points(path, reader, {"more.las"}, options);
}

}  // namespace pcm::test
