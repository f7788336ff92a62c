// The description of a point against what the file has.
#include "pcm/pick/describe_point.h"

#include "pcm/build/builder.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/memory_reader.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <cstdlib>
#include <limits>
#include <map>

using namespace pcm;
using namespace pcm::test;

namespace {

// n / 1000 as a decimal without zeros at the end.
std::string thousandths(long n)
{
    std::string digits = std::to_string(std::labs(n));
    digits.insert(0, digits.size() < 4 ? 4 - digits.size() : 0, '0');
    digits.insert(digits.size() - 3, 1, '.');
    while (digits.back() == '0') digits.pop_back();
    if (digits.back() == '.') digits.pop_back();
    return (n < 0 ? "-" : "") + digits;
}

// All digits of integers of 64 bits, floats as floats, scaled attributes in their unit, decimals of text as they were.
// Not under the thread sanitizer: all of it runs in one thread.
TEST(DescribePoint, PCM_NOT_UNDER_THREAD(SaysEveryDigitOfEveryAttribute))
{
    Schema schema;
    schema.add({"number", ScalarType::u64, 1, 1, 0, ""});
    schema.add({"signed", ScalarType::i64, 1, 1, 0, ""});
    schema.add({"rgb", ScalarType::u16, 3, 1, 0, ""});
    schema.add({"angle", ScalarType::i16, 1, 0.006, 0, ""});
    schema.add({"single", ScalarType::f32, 1, 1, 0, ""});
    schema.add({"time", ScalarType::f64, 1, 1, 0, ""});
    MemoryCloud cloud = random_cloud(schema, std::nullopt, 9000, 3, 5e6);
    for (std::size_t i = 0; i < 9000; ++i) {
        for (std::size_t a = 0; a < 3; ++a)  // decimals, as text files have them
            cloud.points.xyz[a][i] = std::nearbyint(cloud.points.xyz[a][i] * 1000) / 1000;
        cloud.points.attributes[0].as<std::uint64_t>()[i] = std::numeric_limits<std::uint64_t>::max() - i;
        cloud.points.attributes[1].as<std::int64_t>()[i] = std::numeric_limits<std::int64_t>::min() + std::int64_t(i);
    }
    cloud.points.attributes[4].as<float>()[0] = 0.1f;
    const TemporaryFolder folder;
    MemoryReader reader(cloud);
    BuildOptions options;
    options.chunk_points = 20000;  // several levels in a chunk
    build_tree(reader, {"memory"}, folder / "t.pct", options);
    const auto opened = PointCloud::open(folder / "t.pct");
    L2Cache& cache = opened->cache();
    const PointSizes sizes(cache.tree());
    std::map<std::string, std::size_t> by_number;
    for (std::size_t i = 0; i < 9000; ++i) by_number[std::to_string(std::numeric_limits<std::uint64_t>::max() - i)] = i;
    std::size_t found = 0;
    for (NodeId id = 0; id < cache.tree().nodes().size(); ++id) {
        const Node& node = cache.tree().node(id);
        std::vector<float> radii;
        const Chunk chunk = cache.tree().read_chunk(id, ColumnSet::whole(schema));
        if (node.points) sizes.find_radii(id, chunk, radii);
        for (std::uint32_t p = 0; p < node.points; p += 7) {
            if (p % 2)
                cache.get(id, ColumnSet::whole(schema));
            else
                cache.clear();
            const PointDescription described = describe_point(cache, sizes, id, p);
            ASSERT_EQ(described.attributes.size(), 6u);
            ASSERT_EQ(by_number.count(described.attributes[0].text()), 1u);
            const std::size_t i = by_number[described.attributes[0].text()];
            ++found;
            const PointBatch& points = cloud.points;
            for (std::size_t a = 0; a < 3; ++a) {
                EXPECT_EQ(described.position[a], points.xyz[a][i]);
                EXPECT_EQ(std::strtod(described.position_text[a].c_str(), nullptr), points.xyz[a][i]);
            }
            EXPECT_EQ(std::stoll(described.attributes[1].text()), points.attributes[1].as<std::int64_t>()[i]);
            const auto* rgb = points.attributes[2].as<std::uint16_t>() + 3 * i;
            EXPECT_EQ(described.attributes[2].text(),
                      std::to_string(rgb[0]) + " " + std::to_string(rgb[1]) + " " + std::to_string(rgb[2]));
            EXPECT_EQ(described.attributes[3].text(), thousandths(6 * points.attributes[3].as<std::int16_t>()[i]));
            EXPECT_EQ(std::strtof(described.attributes[4].text().c_str(), nullptr),
                      points.attributes[4].as<float>()[i]);
            if (i == 0) EXPECT_EQ(described.attributes[4].text(), "0.1");
            EXPECT_EQ(std::strtod(described.attributes[5].text().c_str(), nullptr),
                      points.attributes[5].as<double>()[i]);
            EXPECT_EQ(described.spacing, static_cast<double>(radii[p]));
            EXPECT_GT(described.spacing, 0);
            EXPECT_EQ(described.grid_step, cache.tree().info().grid.scale[0]);
            std::uint32_t first = 0;
            std::size_t level = node.first_level;
            while (first + node.level_points[level - node.first_level] <= p)
                first += node.level_points[level++ - node.first_level];
            EXPECT_EQ(described.level, level);
        }
        cache.clear();
    }
    EXPECT_GT(found, 1000u);
    EXPECT_THROW(describe_point(cache, sizes, 0, cache.tree().node(0).points), Error);
    EXPECT_THROW(describe_point(cache, sizes, 1000000, 0), Error);
}

// 8489352 steps of 0.1 are 848935.2, whose nearest double is not what the product in double is.
TEST(DescribePoint, SaysStepsOfADecimalGridAsPeopleWriteThem)
{
    Grid grid;
    grid.scale = {0.1, 0.01, 1.0 / 3};
    grid.offset = {0, 1000, 0};
    MemoryCloud cloud = random_cloud(Schema(), grid, 50, 3, 5e6);
    std::map<double, std::size_t> by_x;
    for (std::size_t i = 0; i < 50; ++i) {
        const auto q = std::int64_t(8489352 + 3 * i);
        for (std::size_t a = 0; a < 3; ++a) cloud.points.grid_xyz[a][i] = static_cast<std::int32_t>(q);
        by_x[static_cast<double>(q) * 0.1] = i;
    }
    const TemporaryFolder folder;
    MemoryReader reader(cloud);
    build_tree(reader, {"memory"}, folder / "t.pct", BuildOptions());
    const auto opened = PointCloud::open(folder / "t.pct");
    const PointSizes sizes(opened->cache().tree());
    for (std::uint32_t p = 0; p < 50; ++p) {
        const PointDescription described = describe_point(opened->cache(), sizes, 0, p);
        ASSERT_EQ(by_x.count(described.position[0]), 1u);
        const auto q = static_cast<long>(8489352 + 3 * by_x[described.position[0]]);
        EXPECT_EQ(described.position_text[0], thousandths(100 * q));
        EXPECT_EQ(described.position_text[1], thousandths(10 * q + 1000000));
        // The third coordinate is not on a decimal grid: it has the minimum number of digits that round-trip.
        EXPECT_EQ(std::strtod(described.position_text[2].c_str(), nullptr), described.position[2]);
    }
}

}  // namespace
