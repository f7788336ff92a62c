#include "pcm/io/pipe/limited_reader.h"

#include "pcm/io/pipe/merged_reader.h"
#include "pcm/system/error.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <cmath>
#include <fstream>
#include <limits>

namespace {

using namespace pcm;
using namespace pcm::test;

MemoryCloud with_far_points(std::size_t count)
{
    Schema schema;
    schema.add({"tag", ScalarType::u32});
    MemoryCloud cloud = random_cloud(schema, std::nullopt, count, 5, 100);
    for (std::size_t i = 0; i < count; ++i)
        cloud.points.attributes[0].as<std::uint32_t>()[i] = static_cast<std::uint32_t>(i);
    return cloud;
}

TEST(LimitedReader, LeavesOutCountsAndShowsOne)
{
    MemoryCloud cloud = with_far_points(1000);
    cloud.points.xyz[2][10] = 3.4e38;
    cloud.points.xyz[0][500] = -1e30;
    cloud.points.xyz[1][700] = std::numeric_limits<double>::infinity();
    cloud.points.xyz[1][701] = std::nan("");
    cloud.points.xyz[1][702] = 100;
    for (std::size_t i = 20; i < 80; ++i) cloud.points.xyz[2][i] = 101;  // a whole batch
    LimitedReader reader(std::make_unique<MemoryReader>(cloud), 100);
    EXPECT_FALSE(reader.info().points_known);
    EXPECT_FALSE(reader.seekable());
    std::vector<std::uint32_t> tags;
    PointBatch batch;
    while (reader.read(batch, 20)) {
        ASSERT_GT(batch.size, 0u);
        for (std::size_t i = 0; i < batch.size; ++i) {
            tags.push_back(batch.attributes[0].as<std::uint32_t>()[i]);
            EXPECT_FALSE(std::fabs(batch.xyz[2][i]) > 100);
        }
    }
    EXPECT_EQ(tags.size(), 1000u - 63);
    EXPECT_EQ(std::count(tags.begin(), tags.end(), 702u), 1);  // at the limit
    EXPECT_EQ(std::count(tags.begin(), tags.end(), 701u), 1);  // NaN is for others to treat
    EXPECT_EQ(reader.info().points_left_out, 63u);
    ASSERT_FALSE(reader.info().notes.empty());
    EXPECT_NE(reader.info().notes.back().find("63 points with a coordinate beyond 100"), std::string::npos);
    EXPECT_NE(reader.info().notes.back().find("3.4e+38"), std::string::npos);
}

// What the cloud says of itself is passed on, and nothing is added where no point is far away.
TEST(LimitedReader, SaysNothingWhereNoPointIsFar)
{
    MemoryCloud cloud = with_far_points(100);
    cloud.info.notes = {"a note"};
    cloud.info.metadata = {{"key", {std::byte{7}}}};
    cloud.info.promised_box = Box3d{{-500, -50, 2}, {50, 600, 1e9}};
    LimitedReader reader(std::make_unique<MemoryReader>(cloud), 100);
    EXPECT_EQ(reader.info().promised_box->min, (Vec3d{-100, -50, 2}));
    EXPECT_EQ(reader.info().promised_box->max, (Vec3d{50, 100, 100}));
    const MemoryCloud read = read_all(reader);
    EXPECT_EQ(read.points.size, 100u);
    EXPECT_EQ(reader.info().points_left_out, 0u);
    EXPECT_EQ(reader.info().notes, cloud.info.notes);
    EXPECT_EQ(reader.info().metadata, cloud.info.metadata);

    cloud.points.xyz[1][99] = -101;
    cloud.info.promised_box = Box3d{{-500, 150, 2}, {50, 600, 1e9}};  // all of it is beyond the limit
    LimitedReader one(std::make_unique<MemoryReader>(cloud), 100);
    EXPECT_FALSE(one.info().promised_box);
    EXPECT_EQ(read_all(one).points.size, 99u);
    ASSERT_EQ(one.info().notes.size(), 2u);
    EXPECT_EQ(one.info().notes[0], "a note");
}

TEST(LimitedReader, GridsAndLimitsThatMakeNoSense)
{
    MemoryCloud cloud = random_cloud({}, Grid{{0.01, 0.01, 0.01}, {1000, 0, 0}}, 10, 6);
    for (std::size_t a = 0; a < 3; ++a) std::fill(cloud.points.grid_xyz[a].begin(), cloud.points.grid_xyz[a].end(), 0);
    cloud.points.grid_xyz[0][3] = 1;
    LimitedReader reader(std::make_unique<MemoryReader>(cloud), 1000);
    EXPECT_EQ(read_all(reader).points.size, 9u);
    for (const double limit : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
        EXPECT_THROW(LimitedReader(std::make_unique<MemoryReader>(cloud), limit), Error) << limit;
}

TEST(LimitedReader, FilesAreReadWithTheLimitThatIsAskedFor)
{
    const TemporaryFolder folder;
    std::ofstream(folder / "a.xyz") << "1 2 3\n4 5 1e30\n7 8 9\n";
    std::ofstream(folder / "b.xyz") << "1 2 3\n4 5 6\n7 8 1e38\n";
    ReadOptions options;
    options.largest_coordinate = 1e6;
    MergedReader reader({folder / "a.xyz", folder / "b.xyz"}, options);
    EXPECT_EQ(read_all(reader).points.size, 4u);
    EXPECT_EQ(reader.info().points_left_out, 2u);
}

}  // namespace
