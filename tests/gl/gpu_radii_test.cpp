// Radii from compute shaders against comparing all pairs in double.
#include "tests/clouds.h"
#include "tests/gl/gpu_support.h"
#include "tests/sanitizers.h"

#include "pcm/build/builder.h"
#include "pcm/gl/base/gl_state.h"
#include "pcm/gl/compute/gpu_radii.h"
#include "pcm/io/reader.h"
#include "pcm/tree/verify.h"
#include "pcm/update/append.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

using namespace pcm;
using namespace pcm::test;

namespace {

#define PCM_REQUIRE_COMPUTE                 \
    PCM_REQUIRE_GL(context, Profile::core); \
    try {                                   \
        require_compute_shaders();          \
    } catch (const Error& error) {          \
        GTEST_SKIP() << error.what();       \
    }

struct Points {
    std::vector<Vec3i> steps;
    std::vector<Vec3d> normals;  // empty without
    std::vector<float> radii;
    Vec3d scale{};
};

Points read(const std::filesystem::path& tree)
{
    const auto cloud = PointCloud::open(tree);
    const Schema& schema = cloud->info().schema;
    Points points;
    points.scale = cloud->info().grid.scale;
    for (NodeId id = 0; id < cloud->tree()->nodes().size(); ++id) {
        const auto chunk = cloud->cache().get(id, ColumnSet::all(schema));
        for (std::uint32_t i = 0; i < chunk->points; ++i) {
            points.steps.push_back(chunk->positions->grid(i));
            points.radii.push_back(static_cast<float>(chunk->attributes[*schema.find("radius")]->value(i)));
            if (const auto place = schema.find("normal")) {
                Vec3d n;
                for (std::uint32_t c = 0; c < 3; ++c)
                    n[c] = chunk->attributes[*place]->value(i, c) * schema[*place].scale + schema[*place].offset;
                points.normals.push_back(length(n) > 0 ? normalised(n) : n);
            }
        }
    }
    return points;
}

struct Neighbour {
    double square, across;  // squared distance; distance from the line along the normal
    bool operator<(const Neighbour& o) const { return std::pair(square, across) < std::pair(o.square, o.across); }
};

// The smallest and the largest radius that the point may have: of neighbours at equal distance any may be chosen.
std::pair<double, double> exact_radius(const Points& points, std::size_t p, std::size_t k)
{
    std::vector<Neighbour> all;
    for (std::size_t i = 0; i < points.steps.size(); ++i) {
        if (i == p) continue;
        Vec3d d;
        for (std::size_t a = 0; a < 3; ++a)
            d[a] = static_cast<double>(points.steps[i][a] - points.steps[p][a]) * points.scale[a];
        const double square = dot(d, d);
        if (!points.normals.empty()) d = d - dot(points.normals[p], d) * points.normals[p];
        all.push_back({square, length(d)});
    }
    k = std::min(k, all.size());
    if (k == 0) return {0, 0};
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(k - 1), all.end());
    const double last = all[k - 1].square;
    double least = 0, most = 0;
    for (std::size_t i = 0; i < k; ++i) least = std::max(least, all[i].across);
    for (const Neighbour& n : all)
        if (n.square <= last) most = std::max(most, n.across);
    return {least, most};
}

// Compares the radii of all points with exact ones, or those of `sample` points.
void check(const Points& points, std::size_t k, std::size_t sample = 0)
{
    std::mt19937_64 random(sample);
    double worst = 0;
    const std::size_t count = sample ? sample : points.steps.size();
    for (std::size_t j = 0; j < count; ++j) {
        const std::size_t p = sample ? random() % points.steps.size() : j;
        const auto [least, most] = exact_radius(points, p, k);
        const auto r = static_cast<double>(points.radii[p]);
        ASSERT_TRUE(std::isfinite(r));
        ASSERT_GE(r, least * (1 - 1e-5)) << "point " << p << " of " << points.steps.size();
        ASSERT_LE(r, most * (1 + 1e-5)) << "point " << p << " of " << points.steps.size();
        if (least == most && most > 0) worst = std::max(worst, std::abs(r / most - 1));
    }
    EXPECT_LT(worst, 1e-6);
}

// Gives every point some normal, not of length 1; every tenth is 0.
void add_normals(const std::filesystem::path& tree, const Attribute& attribute = {"normal", ScalarType::f32, 3})
{
    const auto cloud = PointCloud::open(tree, {}, Access::write);
    cloud->add_attribute(attribute);
    Query query;
    query.attributes = {"normal"};
    std::mt19937_64 random(3);
    auto cursor = cloud->edit(query);
    for (EditView view; cursor.getNextData(view); view.mark_written())
        for (std::size_t i = 0; i < view.size(); ++i)
            for (std::uint32_t c = 0; c < 3; ++c)
                view.set(i, 0, i % 10 ? static_cast<float>(random() % 2001) - 1000.0f : 0.0f, c);
    cloud->close();
}

GpuRadiiReport compute(const std::filesystem::path& tree, std::size_t k, std::uint64_t l1_bytes = 16 * megabyte,
                       const L2Options& l2 = {})
{
    GpuRadiiOptions options;
    options.neighbours = k;
    const auto cloud = PointCloud::open(tree, l2, Access::write);
    options.normals = cloud->info().schema.find("normal").has_value();
    const auto l1 = make_l1(l1_bytes);
    const GpuRadiiReport report = compute_radii_on_gpu(cloud, l1, options);
    EXPECT_EQ(report.outcome.points_in, cloud->info().points);
    EXPECT_EQ(report.outcome.points_out, cloud->info().points);
    cloud->close();
    EXPECT_LE(l1->statistics().allocated_bytes, l1_bytes);
    l1->release();
    EXPECT_EQ(drain_gl_errors(), "");
    EXPECT_TRUE(verify_tree(tree).faults.empty());
    return report;
}

// Without and with normals.
void compute_and_check(const std::filesystem::path& tree, std::size_t k, std::size_t sample = 0)
{
    compute(tree, k);
    check(read(tree), k, sample);
    add_normals(tree);
    compute(tree, k);
    check(read(tree), k, sample);
}

std::filesystem::path build(const TemporaryFolder& folder, const std::string& name,
                            const std::vector<std::filesystem::path>& files, std::uint32_t chunk_points)
{
    BuildOptions options;
    options.chunk_points = chunk_points;
    options.threads = 2;
    options.memory_bytes = 128 * megabyte;
    build_tree(files, folder / name, options);
    return folder / name;
}

}  // namespace

// Not under the address sanitizer: much drawing in software.
TEST(GpuRadii, PCM_NOT_UNDER_ADDRESS(AreThoseOfTheNearestPointsWhateverTheShape))
{
    PCM_REQUIRE_COMPUTE
    for (const Shape shape : {Shape::surface, Shape::volume, Shape::line, Shape::coincident, Shape::duplicates,
                              Shape::clusters, Shape::full_range}) {
        SCOPED_TRACE(name(shape));
        const TemporaryFolder folder;
        write_las(folder / "cloud.las", records(shape, 2500, 5), grid);
        const auto tree = build(folder, "cloud.pct", {folder / "cloud.las"}, 1000);
        compute_and_check(tree, 8);
    }
}

TEST(GpuRadii, OfACloudWithFewerPointsThanNeighbours)
{
    PCM_REQUIRE_COMPUTE
    for (const std::size_t count : {1u, 2u, 5u, 9u}) {
        SCOPED_TRACE(count);
        const TemporaryFolder folder;
        write_las(folder / "cloud.las", records(Shape::volume, count, count), grid);
        const auto tree = build(folder, "cloud.pct", {folder / "cloud.las"}, 1000);
        compute_and_check(tree, 8);
        if (count == 1) EXPECT_EQ(read(tree).radii[0], 0.0f);
    }
}

TEST(GpuRadii, PCM_NOT_UNDER_ADDRESS(AnyNumberOfNeighbours))
{
    PCM_REQUIRE_COMPUTE
    for (const std::size_t k : {std::size_t(1), std::size_t(2), std::size_t(37), GpuRadiiOptions::most_neighbours}) {
        SCOPED_TRACE(k);
        const TemporaryFolder folder;
        write_las(folder / "cloud.las", records(Shape::surface, 7000, 9), grid);
        const auto tree = build(folder, "cloud.pct", {folder / "cloud.las"}, 2000);
        const GpuRadiiReport report = compute(tree, k);
        EXPECT_EQ(report.batches > 1, k == GpuRadiiOptions::most_neighbours);
        check(read(tree), k, 300);
        add_normals(tree);
        compute(tree, k);
        check(read(tree), k, 300);
    }
}

TEST(GpuRadii, PCM_NOT_UNDER_ADDRESS(AcrossPartsAndFromNormalsOfAnyType))
{
    PCM_REQUIRE_COMPUTE
    const TemporaryFolder folder;
    write_las(folder / "first.las", records(Shape::surface, 3000, 1), grid);
    write_las(folder / "second.las", records(Shape::surface, 2500, 2), grid);
    write_las(folder / "third.las", records(Shape::volume, 3, 3), grid);
    const auto tree = build(folder, "cloud.pct", {folder / "first.las"}, 1000);
    for (const char* name : {"second.las", "third.las"}) {
        const auto reader = open_reader(folder / name);
        append_points(tree, *reader, {name});
    }
    ASSERT_EQ(Tree::open(tree)->part_roots().size(), 3u);
    compute(tree, 12);
    check(read(tree), 12);
    add_normals(tree, {"normal", ScalarType::i16, 3, 0.001, 0.25});
    compute(tree, 12);
    check(read(tree), 12);
}

// Positions of 64 bits: the coordinates have more digits than 32 bits hold.
TEST(GpuRadii, OfWidePositions)
{
    PCM_REQUIRE_COMPUTE
    const TemporaryFolder folder;
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<std::array<double, 3>> points;
    for (std::size_t i = 0; i < 3000; ++i) {
        const double from = i % 3 == 0 ? 0 : i % 3 == 1 ? 1e9 : -1e9;
        const double size = i % 5 == 0 ? 1000 : 1e-3;
        points.push_back({from + size * unit(random), size * unit(random), from + size * unit(random)});
    }
    write_ply(folder / "cloud.ply", points);
    const auto tree = build(folder, "cloud.pct", {folder / "cloud.ply"}, 1000);
    ASSERT_TRUE(Tree::open(tree)->info().wide);
    compute_and_check(tree, 8);
}

// Squares of distances are beyond what float holds.
TEST(GpuRadii, InUnitsFarFromOne)
{
    PCM_REQUIRE_COMPUTE
    for (const double step : {1e-25, 1e25}) {
        SCOPED_TRACE(step);
        const TemporaryFolder folder;
        write_las(folder / "cloud.las", records(Shape::surface, 1000, 6), Grid{{step, step, step}, {0, 0, 0}});
        const auto tree = build(folder, "cloud.pct", {folder / "cloud.las"}, 1000);
        compute(tree, 8);
        check(read(tree), 8);
    }
}

// Distances from the middle that differ by less than float can say: the wrong neighbours have another radius.
TEST(GpuRadii, NeighboursAreThoseThatDoublesGive)
{
    PCM_REQUIRE_COMPUTE
    for (const double radius : {1e9, 2e9}) {
        SCOPED_TRACE(radius);
        const TemporaryFolder folder;
        std::mt19937_64 random(8);
        std::normal_distribution<double> normal;
        std::vector<LasRecord> points = records(Shape::coincident, 1, 1);
        for (int i = 0; i < 300; ++i) {
            Vec3d p{normal(random), normal(random), normal(random)};
            p = (radius + 3 * i) / length(p) * p;
            LasRecord record = points[0];
            record.x += static_cast<std::int32_t>(p[0]);
            record.y += static_cast<std::int32_t>(p[1]);
            record.z += static_cast<std::int32_t>(p[2]);
            points.push_back(record);
        }
        std::shuffle(points.begin(), points.end(), random);
        write_las(folder / "cloud.las", points, {{0.001, 0.001, 0.001}, {500000, 5000000, 100}});
        const auto tree = build(folder, "cloud.pct", {folder / "cloud.las"}, 1000);
        add_normals(tree);
        for (const std::size_t k : {1u, 8u}) {
            compute(tree, k);
            const Points all = read(tree);
            const auto middle = std::find(all.steps.begin(), all.steps.end(), Vec3i{1, 2, 3}) - all.steps.begin();
            ASSERT_GT(length(all.normals[static_cast<std::size_t>(middle)]), 0);
            check(all, k);
        }
    }
}

// A point in the middle of a shell, of which no box can be left out: a search through a whole chunk.
TEST(GpuRadii, OfAPointThatIsAsFarFromAllOthers)
{
    PCM_REQUIRE_COMPUTE
    const TemporaryFolder folder;
    std::mt19937_64 random(8);
    std::normal_distribution<double> normal;
    std::vector<LasPoint> points(80001);
    for (std::size_t i = 1; i < points.size(); ++i) {
        Vec3d p{normal(random), normal(random), normal(random)};
        p = (1e6 + 0.1 * static_cast<double>(i)) / length(p) * p;
        points[i].x = static_cast<std::int32_t>(p[0]);
        points[i].y = static_cast<std::int32_t>(p[1]);
        points[i].z = static_cast<std::int32_t>(p[2]);
    }
    std::shuffle(points.begin(), points.end(), random);
    make_cloud(folder, "cloud", {{0.001, 0.001, 0.001}, {0, 0, 0}}, points, 100000);
    const auto tree = folder / "cloud.pct";
    ASSERT_EQ(Tree::open(tree)->nodes().size(), 1u);
    compute(tree, 64);
    const Points all = read(tree);
    const auto middle = std::find(all.steps.begin(), all.steps.end(), Vec3i{0, 0, 0}) - all.steps.begin();
    const double expected = exact_radius(all, static_cast<std::size_t>(middle), 64).first;
    EXPECT_NEAR(static_cast<double>(all.radii[static_cast<std::size_t>(middle)]), expected, 1e-6 * expected);
}

// Neighbours lie nearly along the normal: their distance across it is a thousandth of their distance.
TEST(GpuRadii, AcrossNormalsAlongALine)
{
    PCM_REQUIRE_COMPUTE
    const TemporaryFolder folder;
    write_las(folder / "cloud.las", records(Shape::line, 2000, 5), grid);
    const auto tree = build(folder, "cloud.pct", {folder / "cloud.las"}, 1000);
    {
        const auto cloud = PointCloud::open(tree, {}, Access::write);
        cloud->add_attribute({"normal", ScalarType::f32, 3});
        Query query;
        query.attributes = {"normal"};
        auto cursor = cloud->edit(query);
        for (EditView view; cursor.getNextData(view); view.mark_written())
            for (std::size_t i = 0; i < view.size(); ++i) {
                view.set(i, 0, 1000 + double(i % 7), 0);
                view.set(i, 0, 1, 1);
            }
        cloud->close();
    }
    compute(tree, 8);
    check(read(tree), 8);
}

TEST(GpuRadii, PCM_NOT_UNDER_ADDRESS(OfACloudLargerThanBothCaches))
{
    PCM_REQUIRE_COMPUTE
    const TemporaryFolder folder;
    const auto tree = make_tree(folder, "cloud", 70000);
    L2Options l2;
    l2.capacity_bytes = 300000;
    compute(tree, 8, megabyte, l2);
    check(read(tree), 8, 500);
    add_normals(tree);
    compute(tree, 8, megabyte, l2);
    check(read(tree), 8, 500);
}

// A chunk takes several pieces where no block of video memory holds all of it.
TEST(GpuRadii, PCM_NOT_UNDER_ADDRESS(OfAChunkInSeveralPieces))
{
    PCM_REQUIRE_COMPUTE
    const TemporaryFolder folder;
    make_cloud(folder, "cloud", grid, coloured_points(100000, 6), 100000);
    const auto tree = folder / "cloud.pct";
    {
        const auto cloud = PointCloud::open(tree);
        GpuCursor cursor(cloud, make_l1(4 * megabyte), {});
        GpuView view;
        ASSERT_TRUE(cursor.getNextDataGPU(view));
        ASSERT_GT(view.pieces().size(), 1u);
    }
    compute(tree, 8, 4 * megabyte);
    check(read(tree), 8, 500);
}

// Not under the address sanitizer: much drawing in software.
TEST(GpuRadii, PCM_NOT_UNDER_ADDRESS(CancelledTheyLeaveTheTreeAsItWas))
{
    PCM_REQUIRE_COMPUTE
    const TemporaryFolder folder;
    const auto tree = make_tree(folder, "cloud", 20000);
    compute(tree, 4);
    const Points before = read(tree);
    const auto l1 = make_l1(megabyte);
    for (const double fraction : {0.0, 0.5}) {
        const auto cloud = PointCloud::open(tree, {}, Access::write);
        GpuRadiiOptions options;
        options.neighbours = 500;  // three batches: however fast the device is, progress is reported between them
        double reached = 0;
        options.progress = [&](const ProgressUpdate& update) {
            reached = update.fraction;
            return update.fraction < fraction;
        };
        try {
            compute_radii_on_gpu(cloud, l1, options);
            ADD_FAILURE() << "not cancelled";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::cancelled);
            cloud->abandon();
        }
        EXPECT_GE(reached, fraction);
        EXPECT_LT(reached, 1);
    }
    EXPECT_EQ(l1->statistics().failed_write_backs, 0u);
    l1->release();  // writes nothing back
    EXPECT_EQ(read(tree).radii, before.radii);
    EXPECT_EQ(Tree::open(tree)->info().generation, 2u);  // built, then computed once
    compute(tree, 4);
    EXPECT_EQ(read(tree).radii, before.radii);
}

TEST(GpuRadii, RefuseWhatTheyCannotDo)
{
    PCM_REQUIRE_COMPUTE
    const TemporaryFolder folder;
    const auto tree = make_tree(folder, "cloud", 2000);
    const auto refused = [&](const GpuRadiiOptions& options, const char* word, Access access = Access::write) {
        const auto cloud = PointCloud::open(tree, {}, access);
        try {
            compute_radii_on_gpu(cloud, make_l1(megabyte), options);
            ADD_FAILURE() << "not refused: " << word;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
        }
        if (access == Access::write) cloud->abandon();
    };
    GpuRadiiOptions options;
    refused(options, "read", Access::read);
    options.neighbours = 0;
    refused(options, "neighbours is 0");
    options.neighbours = GpuRadiiOptions::most_neighbours + 1;
    refused(options, "neighbours is 1025");
    options.neighbours = 4;
    options.normals = true;
    refused(options, "'normal'");
    options.normals = false;
    {
        const auto cloud = PointCloud::open(tree, {}, Access::write);
        cloud->add_attribute({"radius", ScalarType::f64});
        cloud->close();
    }
    refused(options, "'radius'");
}
