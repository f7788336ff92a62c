#include "pcm/bpc/bpc_file.h"

#include "pcm/bpc/batch_chunk.h"
#include "pcm/bpc/commit_record.h"
#include "pcm/system/error.h"

#include <cmath>
#include <string>

namespace pcm {

BpcFile::BpcFile(const std::filesystem::path& path) : file_(path, File::Mode::read)
{
    has_block_ = has_cloud_block(file_);
    if (!has_block_) {
        read_headers();
        return;
    }
    const std::uint64_t bytes = file_.size();
    CloudBlock block = read_cloud_block(file_, bytes);
    index_ = read_chunk_table(file_, bytes, block);
    cloud_ = std::move(block.cloud);
}

void BpcFile::fail(ErrorCode code, const ChunkPlace& place, const std::string& what) const
{
    throw Error(code, file_.path(),
                "chunk " + std::to_string(place.number) + " at byte " + std::to_string(place.offset) + ": " + what);
}

// The size of a tombstone or a commit record at `offset`; 0 when a chunk with points begins there.
std::uint64_t BpcFile::bytes_to_skip(std::uint64_t offset, std::uint64_t end) const
{
    std::uint64_t bytes = 0;
    if (read_commit(file_, offset, end - offset, bytes)) return bytes;
    const BpcHeader header = read_header(file_, offset, end - offset);
    return header.points == 0 ? header.total_bytes : 0;
}

// Derives the cloud from what the headers of all chunks have in common.
void BpcFile::read_headers()
{
    const std::uint64_t bytes = file_.size();
    bool one_grid = true, finite = true;
    Box3d box;
    while (index_.end().offset < bytes) {
        const ChunkPlace place = index_.end();
        std::uint64_t skipped = 0;
        if (read_commit(file_, place.offset, bytes - place.offset, skipped)) {
            index_.skip(skipped);
            continue;
        }
        const BpcHeader header = read_header(file_, place.offset, bytes - place.offset);
        if (header.points == 0) {
            index_.skip(header.total_bytes);
            continue;
        }
        if (place.number == 0) {
            cloud_.schema = header.schema;
            cloud_.grid = header.grid;
        }
        check(place, header);
        one_grid = one_grid && fits_gridded_batch(header) && header.grid == *cloud_.grid;
        const auto chunk_box = source_box(header);
        if (chunk_box) box.extend(*chunk_box);
        finite = finite && chunk_box;
        index_.add(header.points, header.total_bytes);
    }
    for (std::size_t a = 0; one_grid && cloud_.grid && a < 3; ++a)
        one_grid =
            cloud_.grid->scale[a] > 0 && std::isfinite(cloud_.grid->scale[a]) && std::isfinite(cloud_.grid->offset[a]);
    if (!one_grid) cloud_.grid.reset();
    cloud_.points = index_.end().first_point;
    cloud_.chunks = index_.end().number;
    cloud_.position_type = cloud_.grid ? ScalarType::i32 : ScalarType::f64;
    if (finite && !box.empty()) cloud_.box = box;
}

void BpcFile::check(const ChunkPlace& place, const BpcHeader& header) const
{
    if (header.points == 0) fail(ErrorCode::corrupt, place, "it has no points");
    if (!(header.schema == cloud_.schema)) fail(ErrorCode::corrupt, place, "its attributes are not those of the cloud");
    if (decoded_bytes(header) > most_decoded_bytes)
        fail(ErrorCode::unsupported, place,
             "its " + std::to_string(header.points) + " points take " + std::to_string(decoded_bytes(header)) +
                 " bytes; a chunk of at most " + std::to_string(most_decoded_bytes) + " was expected");
    const auto next = index_.at(place.number + 1);
    if (next && next->first_point != place.first_point + header.points)
        fail(ErrorCode::corrupt, place,
             "its number of points differs from the chunk table, or from when the file was opened");
    if (!has_block_) return;
    if (cloud_.grid && !(fits_gridded_batch(header) && header.grid == *cloud_.grid))
        fail(ErrorCode::corrupt, place, "its positions are not on the cloud's grid");
    if (next && next->offset != place.offset + header.total_bytes)
        fail(ErrorCode::corrupt, place, "its size differs from the chunk table");
}

ChunkPlace BpcFile::after(const ChunkPlace& place, const BpcHeader& header) const
{
    if (const auto known = index_.at(place.number + 1)) return *known;
    ChunkPlace next{place.number + 1, place.first_point + header.points, place.offset + header.total_bytes};
    if (has_block_) return next;
    while (next.offset < index_.end().offset) {
        const std::uint64_t bytes = bytes_to_skip(next.offset, index_.end().offset);
        if (bytes == 0) break;
        next.offset += bytes;
    }
    return next;
}

ChunkPlace BpcFile::find(std::uint64_t point) const
{
    ChunkPlace place = index_.before(point);
    if (index_.knows_every_chunk()) return place;
    for (;;) {
        const ChunkPlace next = after(place, header(place));
        if (next.first_point > point) return place;
        place = next;
    }
}

BpcHeader BpcFile::header(const ChunkPlace& place) const
{
    if (place.offset >= index_.end().offset) fail(ErrorCode::corrupt, place, "it is after the last chunk");
    BpcHeader header = read_header(file_, place.offset, index_.end().offset - place.offset);
    check(place, header);
    return header;
}

DecodedChunk BpcFile::read(const ChunkPlace& place, const ColumnSet& columns) const
{
    const BpcHeader known = header(place);
    return read_chunk(file_, place.offset, known.total_bytes, known.header_bytes, columns,
                      ChunkPositionsMayBe::on_grid_or_doubles);
}

}  // namespace pcm
