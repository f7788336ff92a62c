#include "pcm/update/chunk_subset.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace pcm {
namespace {

std::shared_ptr<const Column> column_of(const Column& from, const std::vector<std::uint32_t>& numbers)
{
    auto column = std::make_shared<Column>(from.type(), from.components());
    column->resize(numbers.size());
    const std::size_t bytes = from.point_bytes();
    for (std::size_t i = 0; i < numbers.size(); ++i)
        std::memcpy(column->data() + i * bytes, from.data() + std::size_t(numbers[i]) * bytes, bytes);
    return column;
}

std::shared_ptr<const ChunkPositions> positions_of(const ChunkPositions& from,
                                                   const std::vector<std::uint32_t>& numbers)
{
    auto positions = std::make_shared<ChunkPositions>();
    for (std::size_t a = 0; a < 3; ++a) {
        std::uint64_t low = std::numeric_limits<std::uint64_t>::max(), high = 0;
        for (const std::uint32_t i : numbers) {
            low = std::min(low, from.relative(i, a));
            high = std::max(high, from.relative(i, a));
        }
        positions->origin[a] = static_cast<std::int64_t>(static_cast<std::uint64_t>(from.origin[a]) + low);
        if (high - low > std::numeric_limits<std::uint32_t>::max()) positions->wide = true;
    }
    const auto fill = [&](auto& axes) {
        using Word = typename std::decay_t<decltype(axes[0])>::value_type;
        for (std::size_t a = 0; a < 3; ++a) {
            axes[a].resize(numbers.size());
            const std::uint64_t shift =
                static_cast<std::uint64_t>(positions->origin[a]) - static_cast<std::uint64_t>(from.origin[a]);
            for (std::size_t i = 0; i < numbers.size(); ++i)
                axes[a][i] = static_cast<Word>(from.relative(numbers[i], a) - shift);
        }
    };
    if (positions->wide)
        fill(positions->wide_xyz);
    else
        fill(positions->narrow_xyz);
    return positions;
}

}  // namespace

Chunk subset_of(const Chunk& chunk, const std::vector<std::uint32_t>& numbers)
{
    Chunk result;
    result.points = static_cast<std::uint32_t>(numbers.size());
    if (chunk.positions) result.positions = positions_of(*chunk.positions, numbers);
    if (chunk.sizes) result.sizes = column_of(*chunk.sizes, numbers);
    for (const auto& column : chunk.attributes)
        result.attributes.push_back(column ? column_of(*column, numbers) : nullptr);
    return result;
}

Box3i box_of(const ChunkPositions& positions)
{
    Box3i box;
    for (std::size_t i = 0; i < positions.size(); ++i) box.extend(positions.grid(i));
    return box;
}

}  // namespace pcm
