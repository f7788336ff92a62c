// Boxes of runs of points against all points.
#include "pcm/gl/compute/chunk_boxes.h"

#include "tests/support.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace pcm;

ChunkPositions random_positions(std::size_t points, bool wide, std::mt19937_64& random)
{
    ChunkPositions positions;
    positions.wide = wide;
    positions.origin = {-5000000000, 17, std::int64_t(1) << 40};
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t i = 0; i < points; ++i)
            if (wide)
                positions.wide_xyz[a].push_back(random() >> (2 + 10 * a));
            else
                positions.narrow_xyz[a].push_back(static_cast<std::uint32_t>(random() >> (32 + 5 * a)));
    return positions;
}

Node random_node(std::size_t points, std::mt19937_64& random)
{
    Node node;
    node.points = static_cast<std::uint32_t>(points);
    for (std::size_t left = points; left > 0;) {
        const std::size_t level = random() % 4 == 0 ? 0 : std::min<std::size_t>(left, 1 + random() % 200);
        node.level_points.push_back(static_cast<std::uint32_t>(level));
        left -= level;
    }
    return node;
}

TEST(ChunkBoxes, AreTightRunsOfOneLevel)
{
    std::mt19937_64 random(1);
    for (int round = 0; round < 40; ++round) {
        const std::size_t points = 1 + random() % 1000;
        const ChunkPositions positions = random_positions(points, round % 2, random);
        const Node node = random_node(points, random);
        const ChunkBoxes boxes(positions, node);
        std::vector<std::size_t> level_of;
        for (std::size_t k = 0; k < node.level_points.size(); ++k)
            level_of.insert(level_of.end(), node.level_points[k], k);
        std::size_t expected = 0;
        for (const std::uint32_t level : node.level_points) expected += (level + 31) / 32;
        EXPECT_EQ(boxes.blocks.size(), expected);
        std::uint32_t next = 0;
        for (std::size_t b = 0; b < boxes.blocks.size(); ++b) {
            const ChunkBoxes::Block& block = boxes.blocks[b];
            ASSERT_EQ(block.first, next);
            ASSERT_GE(block.count, 1u);
            ASSERT_LE(block.count, 32u);
            next += block.count;
            Box3i tight;
            tight.min = tight.max = positions.grid(block.first);
            for (std::uint32_t i = block.first; i < next; ++i) {
                EXPECT_EQ(level_of[i], level_of[block.first]);
                EXPECT_EQ(boxes.block_of(i), b);
                for (std::size_t a = 0; a < 3; ++a) {
                    tight.min[a] = std::min(tight.min[a], positions.grid(i, a));
                    tight.max[a] = std::max(tight.max[a], positions.grid(i, a));
                }
            }
            EXPECT_EQ(boxes.box(b).min, tight.min);
            EXPECT_EQ(boxes.box(b).max, tight.max);
        }
        EXPECT_EQ(next, points);
        EXPECT_EQ(boxes.bytes(), boxes.blocks.size() * sizeof(ChunkBoxes::Block) + sizeof(ChunkBoxes));
    }
    // A node that says less than there is: the rest is one level.
    Node few;
    few.level_points = {10};
    const ChunkBoxes boxes(random_positions(50, false, random), few);
    ASSERT_EQ(boxes.blocks.size(), 3u);
    EXPECT_EQ(boxes.blocks[0].count, 10u);
    EXPECT_EQ(boxes.blocks[1].count, 32u);
    EXPECT_EQ(boxes.blocks[2].count, 8u);
}

// A word after the other, as the shader does.
class Words {
public:
    Words(const PieceBoxes& piece, bool wide) : words_(piece.words), wide_(wide) {}
    std::uint64_t number()
    {
        const std::uint64_t low = word();
        return wide_ ? low | static_cast<std::uint64_t>(word()) << 32 : low;
    }
    std::uint32_t word() { return words_[at_++]; }
    bool ends() const { return at_ == words_.size(); }

private:
    const std::vector<std::uint32_t>& words_;
    const bool wide_;
    std::size_t at_ = 0;
};

TEST(PieceBoxes, HaveGroupsAndBlocksOfTheirPoints)
{
    std::mt19937_64 random(2);
    for (int round = 0; round < 60; ++round) {
        const bool wide = round % 2;
        const std::size_t points = 1 + random() % 3000;
        const ChunkPositions positions = random_positions(points, wide, random);
        const ChunkBoxes chunk(positions, random_node(points, random));
        const auto first = static_cast<std::uint32_t>(random() % points);
        const auto count = static_cast<std::uint32_t>(1 + random() % (points - first));
        const PieceBoxes piece(chunk, first, count, wide);
        const std::size_t last_block = chunk.block_of(first + count - 1),
                          blocks = last_block + 1 - chunk.block_of(first);
        EXPECT_EQ(piece.first_block, chunk.block_of(first));
        EXPECT_EQ(piece.group_blocks, static_cast<std::uint32_t>(std::ceil(std::sqrt(double(blocks)))));
        EXPECT_EQ(piece.groups, (blocks + piece.group_blocks - 1) / piece.group_blocks);
        EXPECT_EQ(piece.box_of(last_block), piece.groups + blocks - 1);
        Words words(piece, wide);
        std::uint32_t next = piece.groups, next_point = 0;
        for (std::size_t box = 0; box < piece.groups + blocks; ++box) {
            std::uint64_t corner[2][3];
            for (auto& end : corner)
                for (std::uint64_t& v : end) v = words.number();
            const std::uint32_t begin = words.word(), end = words.word();
            std::size_t from, to;  // blocks of the chunk
            if (box < piece.groups) {
                ASSERT_EQ(begin, next);
                next = end;
                from = piece.first_block + begin - piece.groups;
                to = piece.first_block + end - piece.groups;
                ASSERT_LE(to - from, piece.group_blocks);
            } else {
                ASSERT_EQ(begin, next_point);
                next_point = end;
                from = piece.first_block + box - piece.groups;
                to = from + 1;
                ASSERT_EQ(chunk.block_of(first + begin), from);
                ASSERT_EQ(chunk.block_of(first + end - 1), from);
            }
            ASSERT_LT(from, to);
            for (std::size_t a = 0; a < 3; ++a) {
                std::uint64_t low = ~std::uint64_t(0), high = 0;
                for (std::size_t b = from; b < to; ++b) {
                    low = std::min(low, chunk.blocks[b].low[a]);
                    high = std::max(high, chunk.blocks[b].high[a]);
                }
                ASSERT_EQ(corner[0][a], low);
                ASSERT_EQ(corner[1][a], high);
            }
        }
        EXPECT_EQ(next, piece.groups + blocks);
        EXPECT_EQ(next_point, count);
        EXPECT_TRUE(words.ends());
    }
}

}  // namespace
