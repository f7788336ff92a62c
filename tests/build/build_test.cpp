// The builder against the input it was given: every point once, bit for bit, whatever the distribution.

#include "pcm/build/builder.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/verify.h"
#include "pcm/tree/verify_levels.h"
#include "tests/build/build_support.h"
#include "tests/clouds.h"
#include "tests/memory_reader.h"
#include "tests/outcome.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

// A LAS record as the tree gives it back.
using Flat = std::array<std::int64_t, 20>;

Flat flatten(const LasRecord& p)
{
    return {p.x,
            p.y,
            p.z,
            p.intensity,
            p.returns & 7,
            p.returns >> 3 & 7,
            p.returns >> 6 & 1,
            p.returns >> 7,
            p.classification & 31,
            p.classification >> 5 & 1,
            p.classification >> 6 & 1,
            p.classification >> 7,
            p.angle,
            p.user,
            p.source,
            p.red,
            p.green,
            p.blue,
            0,
            0};
}

std::vector<Flat> read_back(const Tree& tree)
{
    static const std::vector<std::string> names = {"intensity",           "return_number",       "number_of_returns",
                                                   "scan_direction_flag", "edge_of_flight_line", "classification",
                                                   "synthetic",           "key_point",           "withheld",
                                                   "scan_angle_rank",     "user_data",           "point_source_id"};
    std::vector<Flat> all;
    const Schema& schema = tree.info().schema;
    for (NodeId id = 0; id < tree.nodes().size(); ++id) {
        const Chunk chunk = tree.read_chunk(id, ColumnSet::all(schema));
        for (std::size_t i = 0; i < chunk.points; ++i) {
            Flat flat{};
            for (std::size_t a = 0; a < 3; ++a) flat[a] = chunk.positions->grid(i, a);
            for (std::size_t k = 0; k < names.size(); ++k)
                flat[3 + k] = static_cast<std::int64_t>(chunk.attributes[*schema.find(names[k])]->value(i));
            for (std::uint32_t c = 0; c < 3; ++c)
                flat[15 + c] = static_cast<std::int64_t>(chunk.attributes[*schema.find("rgb")]->value(i, c));
            all.push_back(flat);
        }
    }
    return all;
}

void expect_same_points(const Tree& tree, const std::vector<LasRecord>& records)
{
    std::vector<Flat> in, out = read_back(tree);
    for (const LasRecord& p : records) in.push_back(flatten(p));
    std::sort(in.begin(), in.end());
    std::sort(out.begin(), out.end());
    EXPECT_TRUE(in == out) << in.size() << " points in, " << out.size() << " out";
}

class EveryShape : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Build, EveryShape,
                         testing::Values(Shape::surface, Shape::volume, Shape::line, Shape::coincident,
                                         Shape::duplicates, Shape::clusters, Shape::full_range),
                         [](const auto& info) { return name(info.param); });

TEST_P(EveryShape, EveryPointOnceBitForBit)
{
    const TemporaryFolder folder;
    const auto points = records(GetParam(), 60000, 5);
    Grid grid;
    grid.scale = {0.001, 0.001, 0.001};
    grid.offset = {5e6, 4.8e6, -100};
    write_las(folder / "in.las", points, grid);
    const Stopwatch watch;
    const BuildReport report = build_tree({folder / "in.las"}, folder / "out.pct", small_chunks());
    expect_outcome(report.outcome, points.size(), points.size(), watch);
    EXPECT_EQ(report.outcome.error, 0.0);
    EXPECT_TRUE(report.notes.empty()) << report.notes.front();
    const auto tree = Tree::open(folder / "out.pct");
    EXPECT_EQ(tree->info().grid, grid);
    expect_same_points(*tree, points);

    const VerifyReport verified = verify_tree(folder / "out.pct");
    EXPECT_TRUE(verified.faults.empty()) << verified.faults.front();

    Box3i box;
    for (const LasRecord& p : points) box.extend(Vec3i{p.x, p.y, p.z});
    EXPECT_EQ(tree->info().box, box);
    for (std::size_t k = 0; k < 6; ++k)
        EXPECT_EQ(tree->info().extremes[k][k / 2], k % 2 ? box.max[k / 2] : box.min[k / 2]);
}

// Sizes around a chunk, a pair of chunks and a packed block.
TEST(Build, CountsAtTheBoundaries)
{
    const TemporaryFolder folder;
    for (const std::size_t count :
         {0u, 1u, 2u, 127u, 128u, 129u, 999u, 1000u, 1001u, 1999u, 2000u, 2001u, 4000u, 4001u}) {
        const auto points = records(Shape::surface, count, count);
        write_las(folder / "in.las", points, {});
        BuildOptions options = small_chunks();
        options.overwrite = true;
        build_tree({folder / "in.las"}, folder / "out.pct", options);
        const auto tree = Tree::open(folder / "out.pct");
        EXPECT_EQ(tree->info().points, count);
        expect_same_points(*tree, points);
        EXPECT_TRUE(verify_tree(folder / "out.pct").faults.empty()) << count;
    }
}

// What SPEC F5 promises of levels, checked on a cloud where levels mean something.
TEST(Build, PCM_NOT_UNDER_THREAD(LevelsAreAdditiveAndGetFiner))
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::surface, 200000, 8), {});
    for (const Sampling sampling : {Sampling::poisson, Sampling::grid}) {
        BuildOptions options = small_chunks(2000);
        options.sampling = sampling;
        options.overwrite = true;
        build_tree({folder / "in.las"}, folder / "out.pct", options);
        const auto tree = Tree::open(folder / "out.pct");
        EXPECT_EQ(tree->info().sampling, sampling);
        ASSERT_GE(tree->info().levels, 4);
        std::uint64_t before = 0;
        for (std::uint16_t level = 0; level < tree->info().levels; ++level) {
            const std::uint64_t now = tree->points_to_level(level);
            EXPECT_GT(now, before);
            if (level > 0) EXPECT_LT(now, 10 * before);
            before = now;
        }
        EXPECT_EQ(before, tree->info().points);
        EXPECT_GE(tree->nodes()[0].points, 300u);
        for (const Node& node : tree->nodes()) {
            EXPECT_LE(node.points, 2000u);
            if (node.is_leaf())
                EXPECT_EQ(node.spacing, 0);
            else
                EXPECT_GT(node.spacing, 0);
            if (node.parent == no_node) continue;
            EXPECT_LE(node.spacing, tree->node(node.parent).spacing);
            // Coarse above fine.
            const Node& parent = tree->node(node.parent);
            if (node.points && parent.points)
                EXPECT_GE(node.first_level, parent.first_level + parent.level_points.size());
        }
        const LevelsReport report = verify_levels(*tree, 2);
        EXPECT_TRUE(report.faults.empty()) << report.faults[0];
        ASSERT_EQ(report.levels.size() + 1u, tree->info().levels);
        for (std::size_t level = 0; level < report.levels.size(); ++level) {
            const LevelMeasure& measure = report.levels[level];
            EXPECT_EQ(measure.points, tree->points_to_level(static_cast<std::uint16_t>(level)));
            EXPECT_LT(measure.coverage, 1);
            EXPECT_GT(measure.coverage, 0.5);
            if (sampling == Sampling::grid) continue;
            EXPECT_GE(measure.least_distance, 1);
            EXPECT_LT(measure.least_distance, 1.2);
            EXPECT_LT(measure.variation, 0.25);
        }
    }
}

// Across the borders of many bins, and where clouds are degenerate.
// Not under the sanitizers: a large cloud, on which no other code runs than on the small ones.
TEST(Build, PCM_NOT_UNDER_SANITIZERS(LevelsAreMaximalPoissonSamples))
{
    const TemporaryFolder folder;
    for (const Shape shape : {Shape::surface, Shape::volume, Shape::line, Shape::duplicates}) {
        write_las(folder / "in.las", records(shape, 600000, 21), {});
        BuildOptions options = small_chunks(20000);  // 64 MiB: several bins
        options.overwrite = true;
        build_tree({folder / "in.las"}, folder / "out.pct", options);
        const LevelsReport report = verify_levels(*Tree::open(folder / "out.pct"), 2);
        EXPECT_TRUE(report.faults.empty()) << report.faults[0];
        EXPECT_GE(report.levels.size(), 1u);
    }
}

// The measurement itself against brute force; and it must see what is wrong.
TEST(Build, MeasuringLevelsIsExact)
{
    const TemporaryFolder folder;
    auto spread = records(Shape::volume, 4000, 22);
    for (std::size_t i = 0; i < 5; ++i)  // these stand alone
        spread[800 * i].x += static_cast<std::int32_t>(i + 1) * 30000000;
    write_las(folder / "in.las", spread, {});
    build_tree({folder / "in.las"}, folder / "out.pct", small_chunks(1000));
    const auto tree = Tree::open(folder / "out.pct");
    std::vector<std::pair<Vec3d, std::size_t>> points;
    for (NodeId id = 0; id < tree->nodes().size(); ++id) {
        const Chunk chunk = tree->read_chunk(id, ColumnSet::only_positions());
        for (std::uint32_t i = 0; i < chunk.points; ++i) {
            std::size_t level = 0;
            while (i >= tree->node(id).points_to_level(level)) ++level;
            points.push_back({tree->info().grid.to_source(chunk.positions->grid(i)), level});
        }
    }
    const auto distance = [](const Vec3d& p, const Vec3d& q) { return length(p - q); };
    const LevelsReport report = verify_levels(*tree, 1);
    ASSERT_GE(report.levels.size(), 1u);
    std::uint64_t isolated = 0;
    for (std::size_t level = 0; level < report.levels.size(); ++level) {
        double least = 1e300, farthest = 0;
        std::uint64_t of_level = 0;
        std::vector<double> neighbour;
        for (std::size_t i = 0; i < points.size(); ++i) {
            double nearest = 1e300;
            for (std::size_t j = 0; j < points.size(); ++j)
                if (i != j && points[j].second <= level)
                    nearest = std::min(nearest, distance(points[i].first, points[j].first));
            if (points[i].second > level) {
                farthest = std::max(farthest, nearest);
                continue;
            }
            ++of_level;
            least = std::min(least, nearest);
            if (nearest <= 2 * report.levels[level].spacing) neighbour.push_back(nearest);
        }
        double mean = 0, variance = 0;
        for (const double d : neighbour) mean += d / static_cast<double>(neighbour.size());
        for (const double d : neighbour) variance += (d - mean) * (d - mean) / static_cast<double>(neighbour.size());
        const double spacing = report.levels[level].spacing;
        EXPECT_EQ(report.levels[level].points, of_level);
        EXPECT_EQ(report.levels[level].isolated, of_level - neighbour.size());
        isolated += report.levels[level].isolated;
        EXPECT_NEAR(report.levels[level].least_distance, least / spacing, 1e-9);
        EXPECT_NEAR(report.levels[level].coverage, farthest / spacing, 1e-9);
        EXPECT_NEAR(report.levels[level].variation, std::sqrt(variance) / mean, 1e-9);
    }
    EXPECT_GE(isolated, 1u);  // or nothing is tested

    // Spacings that are not the true ones.
    std::vector<std::byte> bytes;
    {
        const File file(folder / "out.pct" / index_file_name, File::Mode::read);
        bytes.resize(file.size());
        file.read_at(bytes.data(), bytes.size(), 0);
    }
    const TreeIndex index = decode_index(bytes, "index");
    for (const double factor : {1.1, 0.9}) {
        TreeIndex changed = index;
        for (double& spacing : changed.info.spacings) spacing *= factor;
        const std::vector<std::byte> now = encode_index(changed);
        replace_file(folder / "out.pct" / index_file_name, now.data(), now.size());
        EXPECT_FALSE(verify_levels(*Tree::open(folder / "out.pct"), 1).faults.empty()) << factor;
    }
}

// Not under the sanitizers: a limit of memory, of which the sanitizer takes more itself.
TEST(Build, PCM_NOT_UNDER_SANITIZERS(MemoryTooSmallForOneBinMakesManyAndLosesNothing))
{
    const TemporaryFolder folder;
    const auto points = records(Shape::surface, 1500000, 9);
    write_las(folder / "in.las", points, {});
    BuildOptions options = small_chunks(200000);  // bins of 800,000 points: one of them takes more than 64 MiB
    build_tree({folder / "in.las"}, folder / "out.pct", options);
    const auto tree = Tree::open(folder / "out.pct");
    expect_same_points(*tree, points);
    EXPECT_TRUE(verify_tree(folder / "out.pct").faults.empty());
}

// The strided sample misses the points at the end of the file. Under the thread sanitizer others have these threads.
TEST(Build, PCM_NOT_UNDER_THREAD(ADenseSpotThatTheSampleMissed))
{
    const TemporaryFolder folder;
    auto points = records(Shape::surface, 400000, 10);
    const auto pile = records(Shape::duplicates, 500000, 11);
    points.insert(points.end(), pile.begin(), pile.end());
    write_las(folder / "in.las", points, {});
    build_tree({folder / "in.las"}, folder / "out.pct", small_chunks(5000));
    expect_same_points(*Tree::open(folder / "out.pct"), points);
    EXPECT_TRUE(verify_tree(folder / "out.pct").faults.empty());
}

// More points in one place than a bin holds: no cut of space divides them. All are equal in every field, all are
// different, or two of three points are equal; a few points are elsewhere.
TEST(Build, PCM_NOT_UNDER_SANITIZERS(PilesLargerThanABin))
{
    const TemporaryFolder folder;
    const auto few = records(Shape::surface, 1000, 18);
    for (const int kinds : {1, 3, 1000000}) {
        std::vector<LasRecord> points(400000, few[0]);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::size_t kind = kinds == 3 ? (i % 3 == 0 ? i / 3 : 0) : i % static_cast<std::size_t>(kinds);
            points[i].intensity = static_cast<std::uint16_t>(kind);
            points[i].source = static_cast<std::uint16_t>(kind >> 16);
        }
        points.insert(points.end(), few.begin(), few.end());
        write_las(folder / "in.las", points, {});
        BuildOptions options = small_chunks(20000);
        options.overwrite = true;
        std::map<std::string, std::string> one;
        for (const unsigned threads : {1u, 2u, 7u}) {
            options.threads = threads;
            build_tree({folder / "in.las"}, folder / "out.pct", options);
            if (threads == 1) one = contents(folder / "out.pct");
            EXPECT_TRUE(contents(folder / "out.pct") == one) << threads << " threads";
        }
        const auto tree = Tree::open(folder / "out.pct");
        expect_same_points(*tree, points);
        for (const Node& node : tree->nodes()) EXPECT_LE(node.points, 20000u);
        EXPECT_TRUE(verify_tree(folder / "out.pct").faults.empty());
        EXPECT_TRUE(verify_levels(*tree, 2).faults.empty());
    }
}

TEST(Build, SeveralFilesAndFoldersAreOneCloud)
{
    const TemporaryFolder folder;
    fs::create_directory(folder / "tiles");
    const auto a = records(Shape::surface, 3000, 12), b = records(Shape::volume, 4000, 13);
    write_las(folder / "tiles" / "a.las", a, {});
    write_las(folder / "tiles" / "b.las", b, {});
    build_tree({folder / "tiles"}, folder / "out.pct", small_chunks());
    auto both = a;
    both.insert(both.end(), b.begin(), b.end());
    const auto tree = Tree::open(folder / "out.pct");
    expect_same_points(*tree, both);
    EXPECT_EQ(tree->info().sources, (std::vector<std::string>{"a.las", "b.las"}));
}

// A survey has more tiles than a process may have files open.
TEST(Build, ManyTiles)
{
    const TemporaryFolder folder;
    fs::create_directory(folder / "tiles");
    const auto points = records(Shape::surface, 6000, 17);
    for (std::size_t tile = 0; tile < 300; ++tile)
        write_las(folder / "tiles" / (std::to_string(tile) + ".las"),
                  {points.begin() + static_cast<std::ptrdiff_t>(tile * 20),
                   points.begin() + static_cast<std::ptrdiff_t>(tile * 20 + 20)},
                  {});
    rlimit before{};
    getrlimit(RLIMIT_NOFILE, &before);
    rlimit few = before;
    few.rlim_cur = 64;
    setrlimit(RLIMIT_NOFILE, &few);
    build_tree({folder / "tiles"}, folder / "out.pct", small_chunks());
    setrlimit(RLIMIT_NOFILE, &before);
    expect_same_points(*Tree::open(folder / "out.pct"), points);
}

// Tiles of one scale with offsets of their own, as every survey delivers them, are exact too.
TEST(Build, TilesWithOffsetsOfTheirOwn)
{
    const TemporaryFolder folder;
    Grid one, two;
    one.scale = two.scale = {0.001, 0.001, 0.001};
    one.offset = {500000, 4800000, 0};
    two.offset = {501000, 4800000, 0};
    auto a = records(Shape::surface, 3000, 14), b = records(Shape::surface, 3000, 15);
    write_las(folder / "a.las", a, one);
    write_las(folder / "b.las", b, two);
    build_tree({folder / "a.las", folder / "b.las"}, folder / "out.pct", small_chunks());
    for (LasRecord& p : b) p.x += 1000000;
    a.insert(a.end(), b.begin(), b.end());
    const auto tree = Tree::open(folder / "out.pct");
    EXPECT_EQ(tree->info().grid, one);
    EXPECT_FALSE(tree->info().wide);
    EXPECT_EQ(tree->info().position_type, ScalarType::i32);
    expect_same_points(*tree, a);
    EXPECT_LE(tree->info().position_error, 1e-9);
    EXPECT_TRUE(verify_tree(folder / "out.pct").faults.empty());
}

// A gridded cloud that can only be read in order (as LAZ) makes the same points of the same narrow rows; small memory
// makes many bins of it.
TEST(Build, PCM_NOT_UNDER_THREAD(AnyReaderIsAnInput))
{
    const TemporaryFolder folder;
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    schema.add({"wide", ScalarType::f64, 40, 1, 0, ""});  // many bytes a point, so that there is more than one bin
    const Grid grid{{0.01, 0.01, 0.001}, {1000, -2000, 3}};
    const MemoryCloud cloud = random_cloud(schema, grid, 30000, 5);
    std::uint64_t hash[3];
    for (int way = 0; way < 3; ++way) {
        MemoryCloud promised = cloud;
        promised.info.points_known = way != 2;
        if (way == 2) promised.info.points = 7;  // an estimate, and a wrong one
        MemoryReader reader(promised, way == 0);
        const BuildReport report =
            build_tree(reader, {"memory"}, folder / (std::to_string(way) + ".pct"), small_chunks());
        EXPECT_EQ(report.outcome.points_out, 30000u);
        EXPECT_EQ(report.outcome.error, 0);
        const auto tree = Tree::open(folder / (std::to_string(way) + ".pct"));
        EXPECT_FALSE(tree->info().wide);
        EXPECT_EQ(tree->info().grid, grid);
        EXPECT_EQ(tree->info().sources, std::vector<std::string>{"memory"});
        EXPECT_TRUE(verify_tree(tree->folder()).faults.empty());
        hash[way] = tree->info().content_hash;
    }
    EXPECT_EQ(hash[0], hash[1]);
    EXPECT_EQ(hash[0], hash[2]);
}

template <class Scalar>
void float_cloud(double centre, double extent, double bound)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(16);
    std::vector<std::array<Scalar, 3>> points(20000);
    for (auto& p : points)
        for (auto& c : p)
            c = static_cast<Scalar>(centre + extent * (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5));
    write_ply(folder / "in.ply", points);
    const BuildReport report = build_tree({folder / "in.ply"}, folder / "out.pct", small_chunks());
    EXPECT_LE(report.outcome.error, bound);
    const auto tree = Tree::open(folder / "out.pct");
    std::vector<Vec3d> in, out;
    for (const auto& p : points) in.push_back({p[0], p[1], p[2]});
    for (NodeId id = 0; id < tree->nodes().size(); ++id) {
        const Chunk chunk = tree->read_chunk(id, ColumnSet::only_positions());
        for (std::size_t i = 0; i < chunk.points; ++i)
            out.push_back(tree->info().grid.to_source(chunk.positions->grid(i)));
    }
    ASSERT_EQ(in.size(), out.size());
    std::sort(in.begin(), in.end());
    std::sort(out.begin(), out.end());
    for (std::size_t i = 0; i < in.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a) ASSERT_LE(std::fabs(in[i][a] - out[i][a]), bound);
    EXPECT_TRUE(verify_tree(folder / "out.pct").faults.empty());
}

// Bound 0: bit for bit. Around zero floats are finer than any grid, and the bound is the grid's half step.
TEST(Build, FloatsAtMapCoordinatesAreExact) { float_cloud<float>(4.8e6, 1000, 0); }
TEST(Build, DoublesAtMapCoordinatesAreExact) { float_cloud<double>(4.8e6, 1000, 0); }
TEST(Build, FloatsAroundZero) { float_cloud<float>(0, 2, 0x1p-62); }
TEST(Build, DoublesAroundZero) { float_cloud<double>(0, 2, 0x1p-62); }
TEST(Build, TinyClouds) { float_cloud<double>(0, 1e-6, 1e-6 * 0x1p-60); }
TEST(Build, HugeClouds) { float_cloud<double>(0, 1e9, 1e9 * 0x1p-60); }

TEST(Build, PointsWithoutAFinitePositionAreCountedAndLeftOut)
{
    const TemporaryFolder folder;
    const float nan = std::nanf(""), inf = INFINITY;
    write_ply<float>(folder / "in.ply", {{0, 0, 0}, {nan, 0, 0}, {1, 2, 3}, {0, -inf, 0}, {4, 5, inf}});
    const BuildReport report = build_tree({folder / "in.ply"}, folder / "out.pct", small_chunks());
    EXPECT_EQ(report.outcome.points_out, 2u);
    EXPECT_EQ(report.points_skipped, 3u);
    ASSERT_FALSE(report.notes.empty());
    EXPECT_EQ(Tree::open(folder / "out.pct")->info().points_skipped, 3u);
    EXPECT_TRUE(verify_tree(folder / "out.pct").faults.empty());
}

TEST(Build, NothingButNaN)
{
    const TemporaryFolder folder;
    const float nan = std::nanf("");
    write_ply<float>(folder / "in.ply", {{nan, nan, nan}});
    EXPECT_EQ(build_tree({folder / "in.ply"}, folder / "out.pct", small_chunks()).outcome.points_out, 0u);
    EXPECT_TRUE(verify_tree(folder / "out.pct").faults.empty());
}

}  // namespace
