#include "pcm/bpc/bpc_file_writer.h"

#include "pcm/bpc/batch_chunk.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

// The cloud without points. Checks the grid before a file is made.
BpcCloud emptied(const std::filesystem::path& path, const BpcCloud& cloud)
{
    for (std::size_t a = 0; cloud.grid && a < 3; ++a)
        if (!(cloud.grid->scale[a] > 0) || !std::isfinite(cloud.grid->scale[a]) ||
            !std::isfinite(cloud.grid->offset[a]))
            throw Error(ErrorCode::invalid_argument, path,
                        "a grid needs positive scales and finite offsets, found scale " +
                            std::to_string(cloud.grid->scale[a]) + " and offset " +
                            std::to_string(cloud.grid->offset[a]));
    BpcCloud empty = cloud;
    empty.points = empty.chunks = 0;
    empty.box.reset();
    return empty;
}

}  // namespace

std::size_t default_cloud_chunk_points(const Schema& schema)
{
    constexpr std::size_t most_points = 100000, most_bytes = std::size_t{16} << 20;
    return std::clamp<std::size_t>(most_bytes / (3 * sizeof(double) + schema.point_bytes()), 1, most_points);
}

BpcFileWriter::BpcFileWriter(const std::filesystem::path& path, const BpcCloud& cloud)
    : cloud_(emptied(path, cloud)), out_(path)
{
    const std::vector<std::byte> block = encode_cloud_block(cloud_, 0);
    out_.append(block.data(), block.size());
}

void BpcFileWriter::append(const std::vector<std::byte>& chunk)
{
    const BpcHeader header = decode_header(chunk.data(), chunk.size(), out_.path());
    if (const auto box = source_box(header))
        box_.extend(*box);
    else
        finite_ = false;
    out_.append(chunk.data(), chunk.size());
    chunks_.push_back({header.points, chunk.size()});
    cloud_.points += header.points;
    ++cloud_.chunks;
}

void BpcFileWriter::finish()
{
    const std::uint64_t table_offset = out_.size();
    const std::vector<std::byte> table = encode_chunk_table(chunks_);
    out_.append(table.data(), table.size());
    if (finite_ && !box_.empty()) cloud_.box = box_;
    const std::vector<std::byte> block = encode_cloud_block(cloud_, table_offset);
    out_.rewrite(block.data(), block.size(), 0);
    out_.finish();
}

}  // namespace pcm
