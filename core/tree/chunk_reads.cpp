// Reads of a tree's chunks.
#include "pcm/bpc/chunk_decoder.h"
#include "pcm/bpc/chunk_header.h"
#include "pcm/bpc/column_codec.h"
#include "pcm/system/error.h"
#include "pcm/tree/column_shares.h"
#include "pcm/tree/damage.h"
#include "pcm/tree/read_together.h"
#include "pcm/tree/tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

// `read` throws errors without hints.
template <class Read>
auto read_undamaged(const std::filesystem::path& folder, const Read& read)
{
    try {
        return read();
    } catch (const Error& error) {
        if (!is_damage(error)) throw;
        throw DamagedTree(error, folder, "restore the file from a copy, or leave out the damaged chunk");
    }
}

}  // namespace

// What a caller gets of a chunk that was decoded.
Chunk Tree::checked(NodeId id, DecodedChunk decoded, const ColumnSet& columns) const
{
    check(id, decoded.header);
    shares_->learn(decoded.header);
    add_missing_columns(decoded.chunk, info_.schema, columns);
    reads_->add(decoded.chunk, decoded.bytes_read);
    return std::move(decoded.chunk);
}

BpcHeader Tree::read_header(NodeId id) const
{
    const Extent& extent = nodes_.at(id).extent;
    const std::shared_ptr<const ByteSource> file = data_file(extent.file);
    return read_undamaged(folder_, [&] { return pcm::read_header(*file, extent.offset, extent.bytes); });
}

Chunk Tree::read_chunk(NodeId id, const ColumnSet& columns) const
{
    const Node& node = nodes_.at(id);
    if (node.points == 0) return empty_chunk(columns);
    const Extent& extent = node.extent;
    const std::shared_ptr<const ByteSource> file = data_file(extent.file);
    return read_undamaged(folder_, [&] {
        const std::uint64_t at_first = shares_->at_first(extent, columns);
        return checked(id, pcm::read_chunk(*file, extent.offset, extent.bytes, at_first, columns), columns);
    });
}

// The bytes of chunks that lie near each other, followed by codec_slack bytes; none when they cannot be read.
std::vector<std::byte> Tree::read_bytes(const Extent& first, const Extent& last) const
{
    const auto size = static_cast<std::size_t>(last.offset + last.bytes - first.offset);
    try {
        std::vector<std::byte> bytes(size + codec_slack);
        data_file(first.file)->read_at(bytes.data(), size, first.offset);
        return bytes;
    } catch (const Error&) {
        return {};  // each is read alone then, and the error names the one that cannot be read
    }
}

Chunk Tree::decode(const ChunkRequest& request, const std::byte* bytes) const
{
    const Extent& extent = nodes_[request.node].extent;
    return read_undamaged(folder_, [&] {
        return checked(request.node,
                       decode_chunk(bytes, extent.bytes, *data_file(extent.file), extent.offset, request.columns),
                       request.columns);
    });
}

// The place of a chunk that may be read together with others; of no bytes where it must be read alone.
Extent Tree::place_among_others(const ChunkRequest& request) const
{
    try {
        return shares_->are_most(request.columns) ? nodes_.at(request.node).extent : Extent();
    } catch (const std::exception&) {
        return {};  // read_chunk() throws the same for this chunk alone
    }
}

void Tree::read_chunks(const std::vector<ChunkRequest>& requests, const TakeChunk& take) const
{
    std::vector<Extent> places;
    for (const ChunkRequest& request : requests) places.push_back(place_among_others(request));
    std::vector<std::size_t> order(requests.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::pair(places[a].file, places[a].offset) < std::pair(places[b].file, places[b].offset);
    });
    for (std::size_t from = 0, to = 0; from < order.size(); from = to) {
        const Extent& first = places[order[from]];
        for (to = from + 1; to < order.size() && follows(places[order[to - 1]], places[order[to]]); ++to) {
            const Extent& next = places[order[to]];
            if (next.offset + next.bytes - first.offset > most_read_together) break;
        }
        std::vector<std::byte> bytes;
        if (to - from > 1) bytes = read_bytes(first, places[order[to - 1]]);
        for (std::size_t i = from; i < to; ++i) {
            const ChunkRequest& request = requests[order[i]];
            Chunk chunk;
            std::exception_ptr failure;
            try {
                chunk = bytes.empty() ? read_chunk(request.node, request.columns)
                                      : decode(request, bytes.data() + (places[order[i]].offset - first.offset));
            } catch (const std::exception&) {
                failure = std::current_exception();
            }
            take(order[i], std::move(chunk), failure);
        }
    }
}

ChunkPart Tree::read_chunk_part(NodeId id, const ColumnSet& columns,
                                const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted) const
{
    ChunkPart part;
    const Node& node = nodes_.at(id);
    if (node.points == 0) {
        part.chunk = empty_chunk(columns);
        return part;
    }
    const Extent& extent = node.extent;
    const std::shared_ptr<const ByteSource> file = data_file(extent.file);
    DecodedPart decoded = read_undamaged(folder_, [&] {
        DecodedPart found =
            pcm::read_chunk_part(*file, extent.offset, extent.bytes, extent.header_bytes, columns, wanted);
        check(id, found.header);
        return found;
    });
    for (const std::uint32_t s : decoded.kept) {
        part.first.push_back(decoded.header.segments[s].first);
        part.count.push_back(decoded.header.segments[s].count);
    }
    part.chunk = std::move(decoded.chunk);
    add_missing_columns(part.chunk, info_.schema, columns);
    part.bytes_read = decoded.bytes_read;
    reads_->add(part.chunk, part.bytes_read);
    return part;
}

}  // namespace pcm
