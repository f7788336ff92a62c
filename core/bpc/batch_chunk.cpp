#include "pcm/bpc/batch_chunk.h"

#include "pcm/bpc/chunk_encoder.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace pcm {
namespace {

// Stores the codes of one axis relative to the smallest of them.
void put_axis(const std::vector<std::int64_t>& codes, std::size_t axis, ChunkPositions& positions)
{
    const auto origin = static_cast<std::uint64_t>(positions.origin[axis]);
    const auto put = [&](auto& to) {
        using Word = typename std::decay_t<decltype(to)>::value_type;
        to.resize(codes.size());
        for (std::size_t i = 0; i < codes.size(); ++i)
            to[i] = static_cast<Word>(static_cast<std::uint64_t>(codes[i]) - origin);
    };
    if (positions.wide)
        put(positions.wide_xyz[axis]);
    else
        put(positions.narrow_xyz[axis]);
}

ChunkPositions positions_on_grid(const PointColumns& points)
{
    ChunkPositions positions;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int32_t* from = points.grid_xyz[a];
        const std::int32_t low = *std::min_element(from, from + points.size);
        positions.origin[a] = low;
        positions.narrow_xyz[a].resize(points.size);
        for (std::size_t i = 0; i < points.size; ++i)
            positions.narrow_xyz[a][i] = static_cast<std::uint32_t>(from[i]) - static_cast<std::uint32_t>(low);
    }
    return positions;
}

ChunkPositions positions_of_doubles(const PointColumns& points, DoubleCodes& doubles)
{
    ChunkPositions positions;
    std::array<std::vector<std::int64_t>, 3> codes;
    for (std::size_t a = 0; a < 3; ++a) {
        codes[a].resize(points.size);
        code_doubles(points.xyz[a], points.size, a, doubles, codes[a].data());
        const auto [low, high] = std::minmax_element(codes[a].begin(), codes[a].end());
        positions.origin[a] = *low;
        if (static_cast<std::uint64_t>(*high) - static_cast<std::uint64_t>(*low) >
            std::numeric_limits<std::uint32_t>::max())
            positions.wide = true;
    }
    for (std::size_t a = 0; a < 3; ++a) {
        put_axis(codes[a], a, positions);
        codes[a] = {};
    }
    return positions;
}

}  // namespace

std::vector<std::byte> encode_points(const PointColumns& points, const Schema& schema, const std::optional<Grid>& grid)
{
    bool same = points.size > 0 && points.size <= std::numeric_limits<std::uint32_t>::max() &&
                points.gridded == grid.has_value() && points.attributes.size() == schema.size();
    for (std::size_t a = 0; a < 3; ++a)
        same = same && (points.gridded ? points.grid_xyz[a] != nullptr : points.xyz[a] != nullptr);
    if (!same) throw Error(ErrorCode::invalid_argument, {}, "the points have another shape than the cloud");
    Chunk chunk;
    chunk.points = static_cast<std::uint32_t>(points.size);
    for (const Column* column : points.attributes)  // pointers without ownership
        chunk.attributes.push_back(std::shared_ptr<const Column>(std::shared_ptr<const Column>(), column));
    if (points.gridded) {
        chunk.positions = std::make_shared<ChunkPositions>(positions_on_grid(points));
        return encode_chunk(chunk, schema, *grid);
    }
    DoubleCodes doubles;
    chunk.positions = std::make_shared<ChunkPositions>(positions_of_doubles(points, doubles));
    return encode_chunk(chunk, schema, doubles);
}

std::vector<std::byte> encode_batch(const PointBatch& batch, const Schema& schema, const std::optional<Grid>& grid)
{
    PointColumns points;
    points.size = batch.size;
    points.gridded = batch.gridded;
    for (std::size_t a = 0; a < 3; ++a) {
        if (batch.grid_xyz[a].size() == batch.size) points.grid_xyz[a] = batch.grid_xyz[a].data();
        if (batch.xyz[a].size() == batch.size) points.xyz[a] = batch.xyz[a].data();
    }
    for (const Column& column : batch.attributes) points.attributes.push_back(&column);
    return encode_points(points, schema, grid);
}

bool fits_gridded_batch(const BpcHeader& header)
{
    if (header.doubles) return false;
    for (std::size_t a = 0; a < 3; ++a)
        if (header.box.min[a] < std::numeric_limits<std::int32_t>::min() ||
            header.box.max[a] > std::numeric_limits<std::int32_t>::max())
            return false;
    return true;
}

void positions_to(const BpcHeader& header, const ChunkPositions& positions, std::size_t axis, std::size_t first,
                  std::size_t count, double* to)
{
    const std::int64_t origin = positions.origin[axis];
    const auto convert = [&](const auto* relative) {
        if (header.doubles) return decode_doubles(*header.doubles, axis, origin, relative, count, to);
        const double scale = header.grid.scale[axis], offset = header.grid.offset[axis];
        for (std::size_t i = 0; i < count; ++i) {
            const auto q = static_cast<std::int64_t>(static_cast<std::uint64_t>(origin) + relative[i]);
            to[i] = static_cast<double>(q) * scale + offset;
        }
    };
    if (positions.wide)
        convert(positions.wide_xyz[axis].data() + first);
    else
        convert(positions.narrow_xyz[axis].data() + first);
}

void positions_to(const BpcHeader&, const ChunkPositions& positions, std::size_t axis, std::size_t first,
                  std::size_t count, std::int32_t* to)
{
    const auto origin = static_cast<std::uint32_t>(positions.origin[axis]);
    const auto convert = [&](const auto* relative) {
        for (std::size_t i = 0; i < count; ++i)
            to[i] = static_cast<std::int32_t>(origin + static_cast<std::uint32_t>(relative[i]));
    };
    if (positions.wide)
        convert(positions.wide_xyz[axis].data() + first);
    else
        convert(positions.narrow_xyz[axis].data() + first);
}

std::optional<Box3d> source_box(const BpcHeader& header)
{
    Box3d box;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto source = [&](std::int64_t code) {
            return header.doubles ? header.doubles->to_source(code, a) : header.grid.to_source(code, a);
        };
        // NaN and infinities have the outermost codes.
        box.min[a] = source(header.box.min[a]);
        box.max[a] = source(header.box.max[a]);
        if (!std::isfinite(box.min[a]) || !std::isfinite(box.max[a])) return std::nullopt;
    }
    return box;
}

std::uint64_t decoded_bytes(const BpcHeader& header)
{
    std::uint64_t point_bytes = header.wide ? 24 : 12;
    for (const Attribute& attribute : header.schema) point_bytes += attribute.bytes();
    return header.points * point_bytes;
}

}  // namespace pcm
