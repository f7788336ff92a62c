#include "pcm/filter/voxel_grid.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_reader.h"
#include "pcm/update/append.h"
#include "pcm/update/erase.h"

#include "tests/filter/voxel_oracle.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;

class VoxelGrid : public testing::Test {
protected:
    std::shared_ptr<const Tree> tree_of(const MemoryCloud& cloud, std::uint32_t chunk_points = 1000)
    {
        BuildOptions options;
        options.memory_bytes = 64 << 20;
        options.chunk_points = chunk_points;
        options.overwrite = true;
        MemoryReader reader(cloud);
        build_tree(reader, {"memory"}, folder_ / "cloud.pct", options);
        return Tree::open(folder_ / "cloud.pct");
    }
    TemporaryFolder folder_;
};

VoxelGridOptions options_of(double size, std::uint64_t memory = 0, unsigned threads = 2)
{
    VoxelGridOptions options;
    options.voxels.size = size;
    options.count = true;
    options.memory_bytes = memory;  // 0: as many units as possible
    options.threads = threads;
    return options;
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(VoxelGrid, PCM_NOT_UNDER_THREAD(EqualsAMapOfVoxelsOnCloudsOfAllKinds))
{
    struct Case {
        const char* name;
        std::optional<Grid> grid;
        double extent, size;
        Vec3d anchor;
    };
    const Case cases[] = {
        {"on a grid", Grid{{0.001, 0.001, 0.001}, {0, 0, 0}}, 10, 2.5, {0, 0, 0}},
        {"map", Grid{{0.001, 0.001, 0.001}, {500000, 4800000, 100}}, 10, 1.7, {0, 0, 0}},
        {"few points in a voxel", Grid{{0.01, 0.01, 0.01}, {5e5, 4.8e6, 0}}, 1000, 100, {0.5, -3, 1e6}},
        {"one voxel", Grid{{0.001, 0.001, 0.001}, {0.5, 0.5, 0.5}}, 0.4, 1, {0, 0, 0}},
        {"doubles", std::nullopt, 1, 0.13, {0, 0, 0}},
        {"tiny", std::nullopt, 1e-6, 2e-7, {0, 0, 0}},
        {"huge", std::nullopt, 1e9, 3e8, {0, 0, 0}},
        {"huge, small voxels", std::nullopt, 1e9, 1e-3, {0, 0, 0}},
    };
    std::uint64_t seed = 1;
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        MemoryCloud cloud = random_cloud(all_types(), c.grid, 9000, ++seed, c.extent);
        make_categories(cloud);
        const auto tree = tree_of(cloud);
        const MemoryCloud model = points_of(tree);
        VoxelGridOptions options = options_of(c.size);
        options.voxels.anchor = c.anchor;
        VoxelGridReader reader(tree, options);
        const MemoryCloud found = read_all(reader, 777);
        expect_grid(model, found, options.voxels);
        EXPECT_EQ(reader.points_in(), 9000u);
        EXPECT_EQ(reader.points_out(), found.points.size);
        EXPECT_EQ(reader.fraction_read(), 1.0);
        EXPECT_EQ(reader.info().points, found.points.size);
    }
}

// The number of threads and the memory change the order of points at most.
TEST_F(VoxelGrid, ThreadsAndMemoryDoNotChangeTheResult)
{
    MemoryCloud cloud = random_cloud(all_types(), Grid{{0.001, 0.001, 0.001}, {0, 0, 0}}, 20000, 5, 10);
    make_categories(cloud);
    const auto tree = tree_of(cloud);
    std::set<std::string> first;
    for (const auto& [memory, threads] :
         std::vector<std::pair<std::uint64_t, unsigned>>{{0, 1}, {0, 3}, {1 << 30, 2}}) {
        VoxelGridReader reader(tree, options_of(0.9, memory, threads));
        const MemoryCloud found = read_all(reader);
        std::set<std::string> rows;
        for (std::size_t i = 0; i < found.points.size; ++i) {
            std::string row;
            for (std::size_t k = 0; k < 8; ++k) row += bytes_of(found.points.attributes[k], i);
            const Voxel voxel = voxel_of({0.9, {0, 0, 0}}, position_of(found.points, std::nullopt, i));
            rows.insert(row + std::string(reinterpret_cast<const char*>(voxel.data()), sizeof voxel));
        }
        if (first.empty()) first = rows;
        EXPECT_TRUE(rows == first) << memory << " bytes, " << threads << " threads";
    }
}

// One of several voxels has more points than memory holds: it gets a unit of its own and is summed in passing.
TEST_F(VoxelGrid, PCM_NOT_UNDER_THREAD(AVoxelWithMorePointsThanMemoryHolds))
{
    MemoryCloud cloud = random_cloud(all_types(), Grid{{0.0001, 0.0001, 0.0001}, {5e5, 4.8e6, 0}}, 30000, 6, 10);
    make_categories(cloud);
    for (std::size_t i = 0; i < 26000; ++i)
        for (std::size_t a = 0; a < 3; ++a) cloud.points.grid_xyz[a][i] = 20000 + cloud.points.grid_xyz[a][i] / 100;
    for (const std::uint32_t chunk : {1000u, 20000u}) {
        const auto tree = tree_of(cloud, chunk);
        const MemoryCloud model = points_of(tree);
        for (const VoxelPoint point : {VoxelPoint::centroid, VoxelPoint::nearest}) {
            VoxelGridOptions options = options_of(5);
            options.point = point;
            VoxelGridReader reader(tree, options);
            const MemoryCloud found = read_all(reader);
            EXPECT_GT(reader.most_in_one(), 20000u);
            if (point == VoxelPoint::centroid) expect_grid(model, found, options.voxels);
            EXPECT_EQ(found.points.size, voxels_of(model, options.voxels).size());
        }
    }
}

TEST_F(VoxelGrid, PointsOnBordersBelongToTheVoxelAbove)
{
    MemoryCloud cloud = random_cloud({}, std::nullopt, 0, 1);
    const double at[] = {-2, -1.5, -1, -0.5, -0.0, 0.5, 1, std::nextafter(1.0, 0), std::nextafter(-1.0, -2), 3};
    cloud.points.resize(std::size(at));
    for (std::size_t i = 0; i < std::size(at); ++i)
        for (std::size_t a = 0; a < 3; ++a) cloud.points.xyz[a][i] = at[i];
    const auto tree = tree_of(cloud);
    VoxelGridReader reader(tree, options_of(1));
    const MemoryCloud found = read_all(reader);
    // -2 -1.5 -1-; -1 -0.5; 0 0.5 1-; 1; 3
    std::map<double, std::uint32_t> counts;
    for (std::size_t i = 0; i < found.points.size; ++i)
        counts[std::floor(found.points.xyz[0][i])] = found.points.attributes[0].as<std::uint32_t>()[i];
    EXPECT_EQ(counts, (std::map<double, std::uint32_t>{{-2, 3}, {-1, 2}, {0, 3}, {1, 1}, {3, 1}}));
    expect_grid(points_of(tree), found, {1, {0, 0, 0}});
}

// Points at the border of their voxel: the mean does not round to the next one.
TEST_F(VoxelGrid, CentroidsStayInTheirVoxels)
{
    MemoryCloud cloud = random_cloud({}, std::nullopt, 3, 1);
    const double below = std::nextafter(8.0, 0);
    for (std::size_t a = 0; a < 3; ++a) cloud.points.xyz[a] = {below, below, below};
    cloud.points.xyz[0] = {4e6 + 1 - 0x1p-31, 4e6 + 1 - 0x1p-31, 4e6 + 1 - 0x1p-31};
    VoxelGridReader reader(tree_of(cloud), options_of(1));
    const MemoryCloud found = read_all(reader);
    ASSERT_EQ(found.points.size, 1u);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(found.points.xyz[a][0], cloud.points.xyz[a][0]);
}

TEST_F(VoxelGrid, CoincidentPointsSinglePointsAndNone)
{
    for (const std::size_t count : {std::size_t(0), std::size_t(1), std::size_t(9000)}) {
        MemoryCloud cloud = random_cloud(all_types(), Grid{{0.01, 0.01, 0.01}, {5e5, 4.8e6, 0}}, count, 3, 10);
        make_categories(cloud);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t a = 0; a < 3; ++a) cloud.points.grid_xyz[a][i] = 12345;
        const auto tree = tree_of(cloud);
        VoxelGridReader reader(tree, options_of(0.05));
        const MemoryCloud found = read_all(reader);
        ASSERT_EQ(found.points.size, count ? 1u : 0u);
        EXPECT_EQ(reader.fraction_read(), 1.0);
        if (count == 0) continue;
        expect_grid(points_of(tree), found, {0.05, {0, 0, 0}});
        for (std::size_t a = 0; a < 3; ++a)  // exactly
            EXPECT_EQ(found.points.xyz[a][0], cloud.info.grid->to_source(12345, a));
    }
}

// Sums over all points: of voxels, values times counts, against those of the cloud.
TEST_F(VoxelGrid, SumsTimesCountsAreThoseOfTheCloud)
{
    Schema schema;
    schema.add({"weight", ScalarType::f64, 1, 1, 0, {}});
    schema.add({"force", ScalarType::f64, 3, 1, 0, {}});
    for (const double shift : {0.0, 4.8e6}) {
        MemoryCloud cloud = random_cloud(schema, std::nullopt, 50000, 8, 10);
        for (Column& column : cloud.points.attributes)
            for (std::size_t i = 0; i < cloud.points.size * column.components(); ++i)
                column.as<double>()[i] = std::fabs(column.as<double>()[i]);
        for (std::size_t a = 0; a < 3; ++a)
            for (double& x : cloud.points.xyz[a]) x += shift + 20;
        VoxelGridReader reader(tree_of(cloud), options_of(1.5));
        const MemoryCloud found = read_all(reader);
        ASSERT_GT(found.points.size, 1000u);
        const std::uint32_t* const counts = found.points.attributes.back().as<std::uint32_t>();
        const auto expect_sums = [&](const auto& in, const auto& out) {
            long double sum = 0, combined = 0;
            for (std::size_t i = 0; i < cloud.points.size; ++i) sum += in(i);
            for (std::size_t i = 0; i < found.points.size; ++i)
                combined += static_cast<long double>(out(i)) * counts[i];
            EXPECT_NEAR(static_cast<double>(combined / sum), 1, 1e-12);
        };
        for (std::size_t a = 0; a < 3; ++a)
            expect_sums([&](std::size_t i) { return cloud.points.xyz[a][i]; },
                        [&](std::size_t i) { return found.points.xyz[a][i]; });
        for (std::size_t k = 0; k < 2; ++k)
            for (std::uint32_t c = 0; c < schema[k].components; ++c)
                expect_sums([&](std::size_t i) { return cloud.points.attributes[k].value(i, c); },
                            [&](std::size_t i) { return found.points.attributes[k].value(i, c); });
    }
}

// Each point of the result is a point of the cloud with all of its attributes, and none of its voxel is nearer to the
// centroid.
TEST_F(VoxelGrid, NearestKeepsPointsAsTheyAre)
{
    for (const bool gridded : {true, false}) {
        std::optional<Grid> grid;
        if (gridded) grid = Grid{{0.001, 0.001, 0.001}, {5e5, 4.8e6, 0}};
        const MemoryCloud cloud = random_cloud(all_types(), grid, 9000, 12, 10);
        const auto tree = tree_of(cloud);
        const MemoryCloud model = points_of(tree);
        VoxelGridOptions options = options_of(2.5);
        options.point = VoxelPoint::nearest;
        VoxelGridReader reader(tree, options);
        const MemoryCloud found = read_all(reader);
        EXPECT_EQ(found.info.grid, model.info.grid);
        EXPECT_EQ(found.info.position_type, model.info.position_type);
        expect_nearest(model, found, options.voxels);
    }
}

// All parts count, and points that were deleted do not.
TEST_F(VoxelGrid, OfATreeThatWasChanged)
{
    const Grid grid{{0.001, 0.001, 0.001}, {0, 0, 0}};
    MemoryCloud cloud = random_cloud(all_types(), grid, 9000, 20, 10);
    make_categories(cloud);
    tree_of(cloud);
    MemoryCloud more = random_cloud(all_types(), grid, 5000, 21, 10);
    make_categories(more);
    MemoryReader added(more);
    append_points(folder_ / "cloud.pct", added, {"more"});
    Selection corner;
    corner.box = Box3d{{0, 0, 0}, {10, 10, 10}};
    erase_points(folder_ / "cloud.pct", corner, {});
    const auto tree = Tree::open(folder_ / "cloud.pct");
    const MemoryCloud model = points_of(tree);
    ASSERT_LT(model.points.size, 14000u);
    ASSERT_GT(model.points.size, 9000u);
    VoxelGridReader reader(tree, options_of(1.25));
    expect_grid(model, read_all(reader), {1.25, {0, 0, 0}});
}

TEST_F(VoxelGrid, ValuesThatAreNotFiniteAreLeftOut)
{
    Schema schema;
    schema.add({"heat", ScalarType::f32, 1, 1, 0, {}});
    schema.add({"normal", ScalarType::f64, 3, 1, 0, {}});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    MemoryCloud cloud = random_cloud(schema, std::nullopt, 6, 1);
    const float heat[] = {1, NAN, INFINITY, 3, NAN, NAN};
    const double normals[][3] = {{0, 0, 1}, {0, 0, -1}, {nan, 0, 0}, {0, 0, 0}, {0, 3, 0}, {0, 5, 0}};
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t a = 0; a < 3; ++a) cloud.points.xyz[a][i] = i < 4 ? 0.5 : 1.5;
        cloud.points.attributes[0].as<float>()[i] = heat[i];
        std::copy(normals[i], normals[i] + 3, cloud.points.attributes[1].as<double>() + 3 * i);
    }
    VoxelGridReader reader(tree_of(cloud), options_of(1));
    const MemoryCloud found = read_all(reader);
    ASSERT_EQ(found.points.size, 2u);
    const std::size_t first = found.points.xyz[0][0] < 1 ? 0 : 1;
    EXPECT_EQ(found.points.attributes[0].as<float>()[first], 2);
    EXPECT_TRUE(std::isnan(found.points.attributes[0].as<float>()[1 - first]));
    const double* const some = found.points.attributes[1].as<double>();
    EXPECT_EQ(std::fabs(some[3 * first + 2]), 1);  // they cancel: one of them
    EXPECT_EQ(some[3 * (1 - first) + 1], 1);       // brought to length 1
}

TEST_F(VoxelGrid, MajorityAndMeanCanBeChosen)
{
    Schema schema;
    schema.add({"classification", ScalarType::u8, 1, 1, 0, {}});
    schema.add({"zone", ScalarType::i16, 1, 1, 0, {}});
    MemoryCloud cloud = random_cloud(schema, std::nullopt, 5, 1, 0.1);
    for (std::size_t a = 0; a < 3; ++a)
        for (double& x : cloud.points.xyz[a]) x += 0.5;
    const int values[] = {2, -7, 9, 9, -7};
    for (std::size_t i = 0; i < 5; ++i) {
        cloud.points.attributes[0].as<std::uint8_t>()[i] = static_cast<std::uint8_t>(values[i] + 10);
        cloud.points.attributes[1].as<std::int16_t>()[i] = static_cast<std::int16_t>(values[i]);
    }
    const auto tree = tree_of(cloud);
    VoxelGridOptions options = options_of(1);
    {
        VoxelGridReader reader(tree, options);
        const MemoryCloud found = read_all(reader);
        EXPECT_EQ(found.points.attributes[0].value(0), 3);  // the smaller of two equally frequent ones
        EXPECT_EQ(found.points.attributes[1].value(0), 1);  // 6 / 5
    }
    options.by_mean = {"classification"};
    options.by_majority = {"zone"};
    VoxelGridReader reader(tree, options);
    const MemoryCloud found = read_all(reader);
    EXPECT_EQ(found.points.attributes[0].value(0), 11);  // 56 / 5
    EXPECT_EQ(found.points.attributes[1].value(0), -7);
}

TEST_F(VoxelGrid, RefusesVoxelsThatMakeNoSense)
{
    const auto tree = tree_of(random_cloud(all_types(), Grid{{0.01, 0.01, 0.02}, {5e5, 4.8e6, 0}}, 100, 3, 10));
    const auto message = [&](const VoxelGridOptions& options) -> std::string {
        try {
            VoxelGridReader reader(tree, options);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            return error.what();
        }
        return "accepted";
    };
    for (const double size : {0.0, -1.0, std::nan(""), HUGE_VAL})
        EXPECT_NE(message(options_of(size)).find("must be a positive number"), std::string::npos) << size;
    EXPECT_NE(message(options_of(0.015)).find("step of the points' positions"), std::string::npos);
    EXPECT_EQ(message(options_of(0.02)), "accepted");
    VoxelGridOptions options = options_of(0.1);
    options.voxels.anchor = {0, 1e300, 0};
    EXPECT_NE(message(options).find("too small for coordinates"), std::string::npos);
    options.voxels.anchor = {0, std::nan(""), 0};
    EXPECT_NE(message(options).find("anchor"), std::string::npos);
    options = options_of(0.1);
    options.by_majority = {"colour"};
    EXPECT_NE(message(options).find("no attribute 'colour'"), std::string::npos);
    options.by_majority = {"gps_time"};
    EXPECT_NE(message(options).find("only integers"), std::string::npos);
    options.by_majority = options.by_mean = {"scan"};
    EXPECT_NE(message(options).find("both"), std::string::npos);
}

TEST_F(VoxelGrid, MetadataStayAndNotesSayWhatChanges)
{
    Schema schema;
    schema.add({"radius", ScalarType::f32, 1, 1, 0, {}});
    schema.add({"point_count", ScalarType::u16, 1, 1, 0, {}});
    MemoryCloud cloud = random_cloud(schema, std::nullopt, 100, 3, 10);
    cloud.info.metadata.push_back({"las.vlr/LASF_Projection/2112", {std::byte{'W'}, std::byte{'K'}, std::byte{'T'}}});
    VoxelGridReader reader(tree_of(cloud), options_of(3));
    EXPECT_EQ(reader.info().metadata, cloud.info.metadata);
    ASSERT_EQ(reader.info().schema.size(), 3u);
    EXPECT_EQ(reader.info().schema[2].name, "point_count_2");
    std::string notes;
    for (const std::string& note : reader.info().notes) notes += note + "\n";
    EXPECT_NE(notes.find("'radius' is the mean"), std::string::npos) << notes;
    EXPECT_NE(notes.find("point_count_2"), std::string::npos) << notes;
}

}  // namespace
