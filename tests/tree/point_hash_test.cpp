#include "pcm/tree/point_hash.h"

#include "pcm/bpc/checksum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <numeric>
#include <random>

namespace {

using namespace pcm;

Schema some_schema()
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    schema.add({"rgb", ScalarType::u8, 3, 1, 0, ""});
    schema.add({"gps_time", ScalarType::f64, 1, 1, 0, ""});
    return schema;
}

struct Cloud {
    std::vector<Vec3i> positions;
    std::vector<std::vector<std::byte>> attributes;  // one row per point: all its attributes
};

Cloud random_cloud(const Schema& schema, std::size_t points, bool wide)
{
    std::mt19937_64 random(7);
    Cloud cloud;
    for (std::size_t i = 0; i < points; ++i) {
        Vec3i p;
        for (std::int64_t& c : p)
            c = wide ? static_cast<std::int64_t>(random()) >> 3 : static_cast<std::int32_t>(random());
        cloud.positions.push_back(p);
        cloud.attributes.emplace_back();
        for (std::size_t b = 0; b < schema.point_bytes(); ++b)
            cloud.attributes.back().push_back(static_cast<std::byte>(random()));
    }
    return cloud;
}

// The points numbered `order` as a chunk.
Chunk chunk_of(const Cloud& cloud, const Schema& schema, const std::vector<std::size_t>& order)
{
    auto positions = std::make_shared<ChunkPositions>();
    positions->origin = cloud.positions[order[0]];
    for (const std::size_t i : order)
        for (std::size_t a = 0; a < 3; ++a)
            positions->origin[a] = std::min(positions->origin[a], cloud.positions[i][a]);
    positions->wide = true;
    Chunk chunk;
    chunk.points = static_cast<std::uint32_t>(order.size());
    for (std::size_t a = 0; a < 3; ++a)
        for (const std::size_t i : order)
            positions->wide_xyz[a].push_back(static_cast<std::uint64_t>(cloud.positions[i][a]) -
                                             static_cast<std::uint64_t>(positions->origin[a]));
    chunk.positions = positions;
    std::size_t offset = 0;
    for (const Attribute& attribute : schema) {
        auto column = std::make_shared<Column>(attribute);
        column->resize(order.size());
        for (std::size_t k = 0; k < order.size(); ++k)
            std::memcpy(column->data() + k * attribute.bytes(), cloud.attributes[order[k]].data() + offset,
                        attribute.bytes());
        offset += attribute.bytes();
        chunk.attributes.push_back(column);
    }
    return chunk;
}

// As bpc/FORMAT.md states it: the sum of the XXH3 of every point's row, which is the three coordinates with their sign
// bit flipped, then the attributes in schema order.
std::uint64_t stated_hash(const Cloud& cloud, bool wide)
{
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
        std::vector<std::byte> row;
        const auto put = [&](const auto& value) {
            const auto* bytes = reinterpret_cast<const std::byte*>(&value);
            row.insert(row.end(), bytes, bytes + sizeof value);
        };
        for (const std::int64_t c : cloud.positions[i]) {
            if (wide)
                put(static_cast<std::uint64_t>(c) ^ std::uint64_t(1) << 63);
            else
                put(static_cast<std::uint32_t>(c) ^ std::uint32_t(1) << 31);
        }
        row.insert(row.end(), cloud.attributes[i].begin(), cloud.attributes[i].end());
        sum += checksum(row.data(), row.size());
    }
    return sum;
}

class PointHashTest : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(NarrowAndWide, PointHashTest, testing::Bool());

TEST_P(PointHashTest, IsTheOneOfTheFormatInAnyOrder)
{
    const Schema schema = some_schema();
    const RowLayout layout(schema, GetParam());
    EXPECT_EQ(layout.bytes, (GetParam() ? 24u : 12u) + schema.point_bytes());
    const Cloud cloud = random_cloud(schema, 500, GetParam());
    const std::uint64_t stated = stated_hash(cloud, GetParam());
    std::vector<std::size_t> order(500);
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::vector<std::byte> scratch;
    EXPECT_EQ(hash_chunk(chunk_of(cloud, schema, order), layout, scratch), stated);
    std::shuffle(order.begin(), order.end(), std::mt19937_64(1));
    EXPECT_EQ(hash_chunk(chunk_of(cloud, schema, order), layout, scratch), stated);
    // In two chunks, whose hashes add up.
    const std::vector<std::size_t> some(order.begin(), order.begin() + 123), rest(order.begin() + 123, order.end());
    EXPECT_EQ(hash_chunk(chunk_of(cloud, schema, some), layout, scratch) +
                  hash_chunk(chunk_of(cloud, schema, rest), layout, scratch),
              stated);
}

TEST_P(PointHashTest, SeesEveryBitOfEveryPoint)
{
    const Schema schema = some_schema();
    const RowLayout layout(schema, GetParam());
    Cloud cloud = random_cloud(schema, 20, GetParam());
    std::vector<std::size_t> order(20);
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::vector<std::byte> scratch;
    const std::uint64_t before = hash_chunk(chunk_of(cloud, schema, order), layout, scratch);
    for (std::byte& byte : cloud.attributes[13]) {
        byte ^= std::byte(1);
        EXPECT_NE(hash_chunk(chunk_of(cloud, schema, order), layout, scratch), before);
        byte ^= std::byte(1);
    }
    for (std::int64_t& c : cloud.positions[13]) {
        c ^= 1;
        EXPECT_NE(hash_chunk(chunk_of(cloud, schema, order), layout, scratch), before);
        c ^= 1;
    }
    EXPECT_EQ(hash_chunk(chunk_of(cloud, schema, order), layout, scratch), before);
}

}  // namespace
