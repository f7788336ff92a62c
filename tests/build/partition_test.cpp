// Partition: every row of a cloud is in the one bin that the cuts say, bins are small enough, and the number of threads
// does not decide which rows a bin has.

#include "pcm/build/bins/partition.h"

#include "pcm/build/bins/divide_bins.h"
#include "pcm/io/pipe/merged_reader.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree.h"
#include "tests/build/schema_of.h"
#include "tests/memory_reader.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace pcm {
namespace {

using test::MemoryCloud;
using test::MemoryReader;
using Rows = std::vector<std::string>;

const Schema schema = test::schema_of({{ScalarType::u16, 1}, {ScalarType::u8, 3}});
const ProgressFunction no_progress;

Rows rows_of(const std::vector<std::byte>& bytes, std::size_t row_bytes)
{
    Rows rows;
    for (std::size_t at = 0; at < bytes.size(); at += row_bytes)
        rows.emplace_back(reinterpret_cast<const char*>(bytes.data() + at), row_bytes);
    return rows;
}

struct Partitioned {
    Ingested found;
    std::vector<Rows> bins;  // each sorted
    std::uint64_t bin_points = 0;
};

// `piles`: bins may overlap, so only the rows are compared with the cloud.
template <class Coord>
void read_bins(const Bins<Coord>& bins, std::size_t row_bytes, bool piles, Partitioned& result)
{
    std::set<std::size_t> leaves;
    for (const auto& node : bins.top.nodes)
        if (!node.children[0]) EXPECT_TRUE(leaves.insert(node.bin).second) << "two leaves with one bin";
    for (std::size_t bin = 0; bin < bins.scratch->bins(); ++bin) {
        Rows rows = rows_of(bins.scratch->read(bin), row_bytes);
        EXPECT_EQ(rows.size(), bins.scratch->rows(bin));
        if (!rows.empty()) EXPECT_TRUE(leaves.count(bin)) << "rows in a bin that no leaf has";
        for (const std::string& row : rows) {
            if (piles) break;
            EXPECT_EQ(bins.top.bin_of(coordinates_of<Coord>(reinterpret_cast<const std::byte*>(row.data()))), bin);
        }
        std::sort(rows.begin(), rows.end());
        result.bins.push_back(std::move(rows));
    }
}

Partitioned partition_of(PointReader& reader, unsigned threads, bool piles = false, const TreeInfo* like = nullptr)
{
    const test::TemporaryFolder folder;
    Workspace work(folder.path(), std::uint64_t(4) << 20, 500, threads, no_progress);
    Partitioned result;
    const AnyBins bins = partition(reader, work, result.found, like);
    result.bin_points = work.bin_points(reader.info().points);
    std::visit([&](const auto& of) { read_bins(of, result.found.layout.bytes, piles, result); }, bins);
    return result;
}

Partitioned partition_of(const MemoryCloud& cloud, bool seekable, unsigned threads, bool piles = false,
                         const TreeInfo* like = nullptr)
{
    MemoryReader reader(cloud, seekable);
    return partition_of(reader, threads, piles, like);
}

// What partition() promises, counted on the cloud itself. `kept`: the points with finite positions.
void expect_whole(const MemoryCloud& cloud, const std::vector<std::size_t>& kept, const Partitioned& result)
{
    const Ingested& found = result.found;
    EXPECT_EQ(found.schema, cloud.info.schema);
    EXPECT_EQ(found.points_in, cloud.points.size);
    EXPECT_EQ(found.points_skipped, cloud.points.size - kept.size());
    EXPECT_EQ(found.observed.points, kept.size());
    std::vector<std::byte> expected;
    Box3i box;
    double error = 0;
    for (const std::size_t i : kept) {
        Vec3i q;
        for (std::size_t a = 0; a < 3; ++a) {
            if (cloud.points.gridded) {
                q[a] = cloud.points.grid_xyz[a][i];
            } else {
                const double value = cloud.points.xyz[a][i];
                q[a] = std::llrint((value - found.grid.offset[a]) / found.grid.scale[a]);
                error = std::max(error, std::fabs(found.grid.to_source(q[a], a) - value));
            }
        }
        box.extend(q);
        const std::size_t at = expected.size();
        expected.resize(at + found.layout.bytes);
        for (std::size_t a = 0; a < 3; ++a) {
            if (found.layout.coordinate_bytes == 4) {
                const auto c = static_cast<std::uint32_t>(q[a] + (std::int64_t(1) << 31));
                std::memcpy(expected.data() + at + 4 * a, &c, 4);
            } else {
                const auto c = static_cast<std::uint64_t>(q[a]) ^ std::uint64_t(1) << 63;
                std::memcpy(expected.data() + at + 8 * a, &c, 8);
            }
        }
        const std::string intensity = test::bytes_of(cloud.points.attributes[0], i),
                          rgb = test::bytes_of(cloud.points.attributes[1], i);
        std::memcpy(expected.data() + at + 3 * found.layout.coordinate_bytes, intensity.data(), 2);
        std::memcpy(expected.data() + at + 3 * found.layout.coordinate_bytes + 2, rgb.data(), 3);
    }
    EXPECT_EQ(found.observed.hash, hash_rows(expected.data(), kept.size(), found.layout.bytes));
    EXPECT_EQ(found.observed.position_error, error);
    if (!kept.empty())
        for (std::size_t k = 0; k < 6; ++k)
            EXPECT_EQ(found.observed.extremes[k][k / 2], k % 2 ? box.max[k / 2] : box.min[k / 2]);
    Rows all, in = rows_of(expected, found.layout.bytes);
    for (const Rows& bin : result.bins) {
        EXPECT_LE(bin.size(), result.bin_points * 3 / 2);
        all.insert(all.end(), bin.begin(), bin.end());
    }
    std::sort(all.begin(), all.end());
    std::sort(in.begin(), in.end());
    EXPECT_TRUE(all == in) << in.size() << " rows in, " << all.size() << " in bins";
}

std::vector<std::size_t> all_of(const MemoryCloud& cloud)
{
    std::vector<std::size_t> all(cloud.points.size);
    std::iota(all.begin(), all.end(), std::size_t(0));
    return all;
}

const Grid millimetres{{0.001, 0.001, 0.001}, {100, 200, 0}};

MemoryCloud gridded(const std::string& kind, std::size_t count)
{
    MemoryCloud cloud = test::random_cloud(schema, millimetres, count, 11, 1000);
    std::mt19937_64 random(12);
    auto& xyz = cloud.points.grid_xyz;
    for (std::size_t i = 0; i < count; ++i) {
        if (kind == "extremes")
            for (std::size_t a = 0; a < 3; ++a)
                xyz[a][i] = random() % 2 ? std::numeric_limits<std::int32_t>::max()
                                         : std::numeric_limits<std::int32_t>::min() + static_cast<int>(random() % 9);
        if (kind == "line") xyz[1][i] = xyz[2][i] = -5;
        if (kind == "dense spot" && i % 20)  // the end of the file, which few samples see
            for (std::size_t a = 0; a < 3; ++a) xyz[a][i] = static_cast<std::int32_t>(random() % 300);
        if (kind == "pile" && i % 20)
            for (std::size_t a = 0; a < 3; ++a) xyz[a][i] = 7;
        if (kind == "one row") {
            for (std::size_t a = 0; a < 3; ++a) xyz[a][i] = 7;
            for (Column& column : cloud.points.attributes) std::memset(column.data(), 3, column.bytes());
        }
    }
    return cloud;
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST(Partition, PCM_NOT_UNDER_THREAD(OfGriddedClouds))
{
    for (const std::string kind : {"random", "extremes", "line", "dense spot", "pile", "one row"})
        for (const std::size_t count : {0u, 1u, 2u, 900u, 30000u})
            for (const bool seekable : {true, false}) {
                SCOPED_TRACE(kind + ", " + std::to_string(count) + (seekable ? ", seekable" : ""));
                const MemoryCloud cloud = gridded(kind, count);
                const bool piles = kind == "pile" || kind == "one row" || kind == "extremes";
                const Partitioned three = partition_of(cloud, seekable, 3, piles);
                EXPECT_EQ(three.found.grid, millimetres);
                EXPECT_EQ(three.found.layout.coordinate_bytes, 4u);
                expect_whole(cloud, all_of(cloud), three);
                if (count == 30000) EXPECT_GE(three.bins.size(), 10u);
                if (HasFailure()) return;
            }
}

TEST(Partition, DoesNotDependOnThreads)
{
    for (const std::string kind : {"random", "dense spot", "pile"}) {
        const MemoryCloud cloud = gridded(kind, 30000);
        const Partitioned one = partition_of(cloud, true, 1, true);
        for (const unsigned threads : {2u, 5u}) {
            const Partitioned more = partition_of(cloud, true, threads, true);
            EXPECT_TRUE(one.bins == more.bins) << kind << ", " << threads << " threads";
        }
    }
}

MemoryCloud doubles(const std::string& kind, std::size_t count)
{
    const double extent = kind == "huge" ? 1e150 : kind == "tiny" ? 1e-140 : 1000;
    MemoryCloud cloud = test::random_cloud(schema, std::nullopt, count, 13, extent);
    std::mt19937_64 random(14);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            double& value = cloud.points.xyz[a][i];
            if (kind == "map coordinates") value = 4.8e6 + value * 0.1;
            if (kind == "not finite" && random() % 10 == 0)
                value =
                    random() % 2 ? std::numeric_limits<double>::quiet_NaN() : -std::numeric_limits<double>::infinity();
            if (kind == "nothing but NaN") value = std::numeric_limits<double>::quiet_NaN();
            if (kind == "signed zeros") value = random() % 2 ? 0.0 : -0.0;
        }
    return cloud;
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST(Partition, PCM_NOT_UNDER_THREAD(OfDoubles))
{
    for (const std::string kind :
         {"random", "map coordinates", "not finite", "nothing but NaN", "signed zeros", "huge", "tiny"})
        for (const std::size_t count : {0u, 1u, 2u, 30000u}) {
            SCOPED_TRACE(kind + ", " + std::to_string(count));
            const MemoryCloud cloud = doubles(kind, count);
            std::vector<std::size_t> kept;
            Vec3d largest{0, 0, 0};
            for (std::size_t i = 0; i < count; ++i) {
                bool finite = true;
                for (std::size_t a = 0; a < 3; ++a) finite = finite && std::isfinite(cloud.points.xyz[a][i]);
                if (!finite) continue;
                kept.push_back(i);
                for (std::size_t a = 0; a < 3; ++a)
                    largest[a] = std::max(largest[a], std::fabs(cloud.points.xyz[a][i]));
            }
            const Partitioned result = partition_of(cloud, false, 3, kind == "signed zeros" || kind == "tiny");
            EXPECT_EQ(result.found.layout.coordinate_bytes, 8u);
            expect_whole(cloud, kept, result);
            // Half of a unit in the last place of the largest coordinate, and less; no step is below 2^-491.
            EXPECT_LE(result.found.observed.position_error,
                      std::max(std::ldexp(std::max({largest[0], largest[1], largest[2]}), -54), 0x1p-492));
            if (HasFailure()) return;
        }
}

TEST(Partition, TakesTheGridOfATree)
{
    const MemoryCloud cloud = doubles("random", 5000);
    TreeInfo like;
    like.grid = Grid{{0.01, 0.02, 0.01}, {3, 4, 5}};
    for (const bool wide : {false, true}) {
        like.wide = wide;
        const Partitioned result = partition_of(cloud, false, 2, false, &like);
        EXPECT_EQ(result.found.grid, like.grid);
        EXPECT_EQ(result.found.layout.coordinate_bytes, wide ? 8u : 4u);
        expect_whole(cloud, all_of(cloud), result);
    }
}

// Sources of integers on a grid, of floats, of doubles with few decimals, and of doubles that were integers.
TEST(Partition, KnowsTheTypeAndTheDecimalsOfTheSource)
{
    const DecimalPlaces none{no_decimals, no_decimals, no_decimals};
    for (const std::size_t count : {100u, 30000u}) {
        for (const bool seekable : {true, false}) {
            const Ingested found = partition_of(gridded("random", count), seekable, 2).found;
            EXPECT_EQ(found.position_type, ScalarType::i32);
            EXPECT_EQ(found.decimals, none);
        }
        MemoryCloud cloud = doubles("random", count);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t a = 0; a < 3; ++a) {
                const double places = a == 1 ? 1e4 : 100;
                cloud.points.xyz[a][i] = std::nearbyint(cloud.points.xyz[a][i] * places) / places;
            }
        // Next to coordinates of 1000 the grid cannot hold all bits of this one.
        for (std::size_t a = 0; a < 3; ++a) cloud.points.xyz[a][1] = a == 1 ? 0.0003 : 0.07;
        TreeInfo like;
        like.grid = Grid{{1e-5, 1e-5, 1e-5}, {0, 0, 0}};
        for (const ScalarType type : {ScalarType::f32, ScalarType::f64}) {
            cloud.info.position_type = type;
            const Ingested found = partition_of(cloud, false, 2).found;
            EXPECT_EQ(found.position_type, type);
            EXPECT_EQ(found.decimals, type == ScalarType::f64 ? (DecimalPlaces{2, 4, 2}) : none);
            const Ingested as_tree = partition_of(cloud, false, 2, false, &like).found;
            EXPECT_EQ(as_tree.position_type, type);
            EXPECT_EQ(as_tree.decimals, none);
        }
        cloud.info.near_grid = Grid{{1e-4, 1e-4, 1e-4}, {5, 0, 0}};
        const Ingested found = partition_of(cloud, false, 2).found;
        EXPECT_EQ(found.grid, *cloud.info.near_grid);
        EXPECT_EQ(found.position_type, ScalarType::i32);
        EXPECT_EQ(found.decimals, none);
        EXPECT_EQ(found.layout.coordinate_bytes, 4u);
        // Numbers of which no bit is lost need no decimals.
        MemoryCloud exact = doubles("random", count);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t a = 0; a < 3; ++a) exact.points.xyz[a][i] = std::nearbyint(exact.points.xyz[a][i] * 2) / 2;
        EXPECT_EQ(partition_of(exact, false, 2).found.decimals, none);
    }
}

// Tiles with offsets of their own: the same points, with the same error, as by way of doubles.
TEST(Partition, KeepsTheIntegersOfTiles)
{
    std::vector<MemoryCloud> tiles;
    for (const Vec3d& offset : {Vec3d{100, 200, 0}, Vec3d{100.37, -12345.678, 1}, Vec3d{100000, 1e5, -0.001}}) {
        tiles.push_back(test::random_cloud(schema, Grid{millimetres.scale, offset}, 3000, 11 + tiles.size()));
        Box3d& box = tiles.back().info.promised_box.emplace();
        for (auto& column : tiles.back().points.grid_xyz)
            for (std::int32_t& q : column) q /= 2;
        box.min = offset + Vec3d{-1.1e6, -1.1e6, -1.1e6};
        box.max = offset + Vec3d{1.1e6, 1.1e6, 1.1e6};
    }
    std::vector<MergedReader::Source> sources;
    for (const MemoryCloud& tile : tiles)
        sources.push_back({"tile", [&tile] { return std::make_unique<MemoryReader>(tile, false); }});
    MergedReader straight(sources), other(sources);
    ASSERT_TRUE(straight.can_keep_integers());
    const MemoryCloud doubles = test::read_all(other);
    ASSERT_FALSE(doubles.points.gridded);
    const Partitioned found = partition_of(straight, 2), expected = partition_of(doubles, false, 2);
    EXPECT_EQ(found.found.grid, millimetres);
    EXPECT_EQ(expected.found.grid, millimetres);
    EXPECT_EQ(found.found.observed.points, 9000u);
    EXPECT_EQ(found.found.observed.hash, expected.found.observed.hash);
    EXPECT_EQ(found.found.observed.extremes, expected.found.observed.extremes);
    EXPECT_EQ(found.found.observed.position_error, expected.found.observed.position_error);
    EXPECT_GT(found.found.observed.position_error, 0);
    EXPECT_EQ(found.found.position_type, ScalarType::i32);
}

// All points are rounded down, or all up: the error is the same.
TEST(Partition, TheErrorHasNoSign)
{
    TreeInfo like;
    like.grid = Grid{{0.25, 0.25, 0.25}, {0, 0, 0}};
    like.wide = true;
    for (const double beyond : {0.0625, -0.0625}) {
        MemoryCloud cloud = doubles("random", 500);
        for (std::size_t i = 0; i < 500; ++i)
            for (std::size_t a = 0; a < 3; ++a) {
                double& value = cloud.points.xyz[a][i];
                value = std::nearbyint(value / 0.25) * 0.25 + (i == 7 && a == 1 ? beyond : 0);
            }
        const Partitioned result = partition_of(cloud, false, 2, false, &like);
        EXPECT_EQ(result.found.observed.position_error, 0.0625) << beyond;
    }
}

TEST(Partition, StopsWhenItIsCancelled)
{
    const test::TemporaryFolder folder;
    const MemoryCloud cloud = gridded("random", 300000);
    const ProgressFunction cancel = [](const ProgressUpdate&) { return false; };
    Workspace work(folder.path(), std::uint64_t(4) << 20, 500, 2, cancel);
    try {
        // Progress is reported ten times per second at most, so a first partition may end before it is asked to stop.
        const auto start = std::chrono::steady_clock::now();
        while (std::chrono::steady_clock::now() - start < std::chrono::seconds(30)) {
            MemoryReader reader(cloud, false);
            Ingested found;
            partition(reader, work, found);
        }
        ADD_FAILURE() << "not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
}

}  // namespace
}  // namespace pcm
