#include "pcm/gl/compute/chunk_boxes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

using Corner = std::array<std::uint64_t, 3>;

template <class T>
void find_box(const std::array<PageVector<T>, 3>& xyz, ChunkBoxes::Block& block)
{
    for (std::size_t a = 0; a < 3; ++a) {
        T low = std::numeric_limits<T>::max(), high = 0;
        for (std::size_t i = block.first; i < block.first + block.count; ++i) {
            low = std::min(low, xyz[a][i]);
            high = std::max(high, xyz[a][i]);
        }
        block.low[a] = low;
        block.high[a] = high;
    }
}

void put(std::vector<std::uint32_t>& words, const Corner& corner, bool wide)
{
    for (const std::uint64_t v : corner) {
        words.push_back(static_cast<std::uint32_t>(v));
        if (wide) words.push_back(static_cast<std::uint32_t>(v >> 32));
    }
}

}  // namespace

ChunkBoxes::ChunkBoxes(const ChunkPositions& positions, const Node& node) : origin(positions.origin)
{
    const auto points = static_cast<std::uint32_t>(positions.size());
    blocks.reserve(points / block_points + node.level_points.size());
    std::uint32_t level_end = 0;
    std::size_t level = 0;
    for (std::uint32_t first = 0; first < points; first += blocks.back().count) {
        while (level_end <= first)
            level_end = level < node.level_points.size() ? level_end + node.level_points[level++] : points;
        Block block;
        block.first = first;
        block.count = std::min({block_points, level_end - first, points - first});
        positions.wide ? find_box(positions.wide_xyz, block) : find_box(positions.narrow_xyz, block);
        blocks.push_back(block);
    }
}

Box3i ChunkBoxes::box(std::size_t block) const
{
    Box3i box;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto from = static_cast<std::uint64_t>(origin[a]);
        box.min[a] = static_cast<std::int64_t>(from + blocks[block].low[a]);
        box.max[a] = static_cast<std::int64_t>(from + blocks[block].high[a]);
    }
    return box;
}

std::size_t ChunkBoxes::block_of(std::uint32_t point) const
{
    const auto after = std::upper_bound(blocks.begin(), blocks.end(), point,
                                        [](std::uint32_t p, const Block& block) { return p < block.first; });
    return static_cast<std::size_t>(after - blocks.begin()) - 1;
}

PieceBoxes::PieceBoxes(const ChunkBoxes& chunk, std::uint32_t first, std::uint32_t count, bool wide)
    : first_block(chunk.block_of(first))
{
    const std::size_t blocks = chunk.block_of(first + count - 1) + 1 - first_block;
    group_blocks = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(blocks))));
    groups = static_cast<std::uint32_t>((blocks + group_blocks - 1) / group_blocks);
    words.reserve((groups + blocks) * (wide ? 14 : 8));
    for (std::size_t g = 0; g < groups; ++g) {
        const std::size_t begin = g * group_blocks;
        const std::size_t end = std::min<std::size_t>(begin + group_blocks, blocks);
        Corner low = chunk.blocks[first_block + begin].low, high = chunk.blocks[first_block + begin].high;
        for (std::size_t b = begin + 1; b < end; ++b)
            for (std::size_t a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], chunk.blocks[first_block + b].low[a]);
                high[a] = std::max(high[a], chunk.blocks[first_block + b].high[a]);
            }
        put(words, low, wide);
        put(words, high, wide);
        words.push_back(groups + static_cast<std::uint32_t>(begin));
        words.push_back(groups + static_cast<std::uint32_t>(end));
    }
    for (std::size_t b = first_block; b < first_block + blocks; ++b) {
        const ChunkBoxes::Block& block = chunk.blocks[b];
        put(words, block.low, wide);
        put(words, block.high, wide);
        words.push_back(std::max(block.first, first) - first);
        words.push_back(std::min(block.first + block.count, first + count) - first);
    }
}

}  // namespace pcm
