#include "pcm/bpc/chunk_decoder.h"

#include "pcm/bpc/checksum.h"
#include "pcm/bpc/chunk_bytes.h"
#include "pcm/bpc/column_codec.h"
#include "pcm/bpc/layout.h"
#include "pcm/bpc/scalar_words.h"
#include "pcm/cloud/with_type.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <numeric>

namespace pcm {
namespace {

// Decodes pieces of columns into the columns of a chunk with the points of the kept segments.
class ChunkDecoder {
public:
    ChunkDecoder(const BpcHeader& header, const ColumnSet& columns, const std::vector<std::uint32_t>& kept)
        : header_(header), kept_(kept)
    {
        for (const std::uint32_t s : kept) {
            at_.push_back(points_);
            points_ += header.segments[s].count;
        }
        chunk_.points = static_cast<std::uint32_t>(points_);
        chunk_.attributes.resize(header.schema.size());
        if (columns.positions) {
            want(header.positions, of_positions);
            positions_ = std::make_shared<ChunkPositions>();
            positions_->origin = header.box.min;
            positions_->wide = header.wide;
        }
        for (std::size_t i = 0; i < header.schema.size(); ++i) {
            if (!columns.attributes.test(i)) continue;
            want(header.attributes[i], static_cast<int>(i));
        }
        if (columns.sizes && header.sizes) want(*header.sizes, of_sizes);
    }

    // A piece to read, its column and its kept segment.
    static constexpr int of_positions = -1, of_sizes = -2;
    struct Wanted {
        const BpcPiece* piece;
        int attribute;  // index in the schema, or one of the above
        std::size_t kept;
    };
    const std::vector<Wanted>& wanted() const { return wanted_; }

    // `data` is followed by codec_slack bytes.
    void decode(const Wanted& wanted, const std::byte* data)
    {
        const auto size = static_cast<std::size_t>(wanted.piece->bytes);
        if (checksum(data, size) != wanted.piece->checksum)
            throw Error(ErrorCode::corrupt, {}, "the checksum of '" + name(wanted) + "' does not match");
        const std::size_t used = wanted.attribute == of_positions ? decode_positions(wanted.kept, data, size)
                                                                  : decode_scalars(wanted, data, size);
        if (used != size) throw Error(ErrorCode::corrupt, {}, "'" + name(wanted) + "' is followed by stray bytes");
    }

    Chunk finish()
    {
        chunk_.positions = std::move(positions_);
        for (std::size_t i = 0; i < columns_.size(); ++i) chunk_.attributes[i] = std::move(columns_[i]);
        chunk_.sizes = std::move(sizes_);
        return std::move(chunk_);
    }

private:
    std::string name(const Wanted& wanted) const
    {
        if (wanted.attribute == of_positions) return "positions";
        return wanted.attribute == of_sizes ? attribute_of_sizes().name
                                            : header_.schema[static_cast<std::size_t>(wanted.attribute)].name;
    }

    void want(const BpcColumn& column, int attribute)
    {
        if (attribute != of_positions) {
            columns_.resize(header_.schema.size());
            std::shared_ptr<Column>& to = column_of(attribute);
            to = std::make_shared<Column>(attribute == of_sizes ? attribute_of_sizes()
                                                                : header_.schema[static_cast<std::size_t>(attribute)]);
            if (!column.constant.empty()) {
                to->resize(points_);
                fill(*to, column.constant);
                return;
            }
        }
        for (std::size_t k = 0; k < kept_.size(); ++k) wanted_.push_back({&column.pieces[kept_[k]], attribute, k});
    }

    std::shared_ptr<Column>& column_of(int attribute)
    {
        return attribute == of_sizes ? sizes_ : columns_[static_cast<std::size_t>(attribute)];
    }

    static void fill(Column& column, const std::vector<std::uint64_t>& words)
    {
        with_type(column.type(), [&](auto scalar) {
            using T = decltype(scalar);
            T* values = column.as<T>();
            const std::size_t n = words.size(), points = column.size();
            for (std::size_t c = 0; c < n; ++c) {
                const T value = from_word<T>(static_cast<WordOf<T>>(words[c]));
                if (n == 1)
                    std::fill_n(values, points, value);
                else
                    for (std::size_t i = 0; i < points; ++i) values[i * n + c] = value;
            }
            return 0;
        });
    }

    std::size_t decode_positions(std::size_t kept, const std::byte* data, std::size_t size)
    {
        return header_.wide ? decode_axes(positions_->wide_xyz, kept, data, size)
                            : decode_axes(positions_->narrow_xyz, kept, data, size);
    }

    template <class Word>
    std::size_t decode_axes(std::array<PageVector<Word>, 3>& axes, std::size_t kept, const std::byte* data,
                            std::size_t size)
    {
        const BpcSegment& segment = header_.segments[kept_[kept]];
        std::size_t used = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            if (axes[a].size() < points_)
                axes[a].resize(points_);  // only after the first piece was decoded: damage must not cost memory
            Word* to = axes[a].data() + at_[kept];
            used += unpack(data + used, size - used, to, segment.count, {});
            Word low = to[0], high = low;
            for (std::size_t i = 1; i < segment.count; ++i) {
                low = std::min(low, to[i]);
                high = std::max(high, to[i]);
            }
            const auto limit = [&](std::int64_t corner) {
                return static_cast<std::uint64_t>(corner) - static_cast<std::uint64_t>(header_.box.min[a]);
            };
            if (low < limit(segment.box.min[a]) || high > limit(segment.box.max[a]))
                throw Error(ErrorCode::corrupt, {}, "a point lies outside the box in the chunk's header");
        }
        return used;
    }

    std::size_t decode_scalars(const Wanted& wanted, const std::byte* data, std::size_t size)
    {
        Column& column = *column_of(wanted.attribute);
        if (column.size() < points_) column.resize(points_);
        const std::size_t count = header_.segments[kept_[wanted.kept]].count, first = at_[wanted.kept];
        return with_type(column.type(), [&](auto scalar) {
            using T = decltype(scalar);
            std::vector<WordOf<T>>& words = scratch(WordOf<T>());
            words.resize(count);
            const std::size_t n = column.components();
            T* values = column.as<T>() + first * n;
            std::size_t used = 0;
            for (std::size_t c = 0; c < n; ++c) {
                used += unpack(data + used, size - used, words.data(), count, {});
                for (std::size_t i = 0; i < count; ++i) values[i * n + c] = from_word<T>(words[i]);
            }
            return used;
        });
    }

    std::vector<std::uint32_t>& scratch(std::uint32_t) { return narrow_words_; }
    std::vector<std::uint64_t>& scratch(std::uint64_t) { return wide_words_; }

    const BpcHeader& header_;
    const std::vector<std::uint32_t>& kept_;
    std::vector<std::size_t> at_;  // the first point of each kept segment in the result
    std::size_t points_ = 0;
    std::vector<Wanted> wanted_;
    Chunk chunk_;
    std::shared_ptr<ChunkPositions> positions_;
    std::vector<std::shared_ptr<Column>> columns_;
    std::shared_ptr<Column> sizes_;
    std::vector<std::uint32_t> narrow_words_;
    std::vector<std::uint64_t> wide_words_;
};

// Decodes the given columns of the kept segments. Pieces that lie near each other are read together. Returns the bytes
// of the pieces.
std::uint64_t decode_segments(ChunkBytes& bytes, const BpcHeader& header, const ColumnSet& columns,
                              const std::vector<std::uint32_t>& kept, Chunk& chunk)
{
    ChunkDecoder decoder(header, columns, kept);
    const auto& wanted = decoder.wanted();
    const auto end = [&](std::size_t i) { return wanted[i].piece->offset + wanted[i].piece->bytes; };
    std::uint64_t used = 0;
    for (std::size_t from = 0; from < wanted.size();) {
        std::size_t to = from + 1;
        while (to < wanted.size() && wanted[to].piece->offset >= end(to - 1) &&
               wanted[to].piece->offset - end(to - 1) <= join_gap)
            ++to;
        const std::uint64_t start = wanted[from].piece->offset, size = end(to - 1) - start;
        const std::byte* const data = bytes.get(start, size);
        for (; from < to; ++from) {
            decoder.decode(wanted[from], data + (wanted[from].piece->offset - start));
            used += wanted[from].piece->bytes;
        }
    }
    chunk = decoder.finish();
    return used;
}

BpcHeader decode_known_header(const ChunkBytes& chunk, std::uint64_t bytes)
{
    BpcHeader header = decode_header(chunk.beginning(), static_cast<std::size_t>(chunk.beginning_size()), {});
    if (header.total_bytes != bytes)
        throw Error(ErrorCode::corrupt, {}, "its length differs from the one in the index");
    return header;
}

// The chunk of `bytes` bytes at `offset`, with its first bytes.
ChunkBytes beginning_of(const ByteSource& file, std::uint64_t offset, std::uint64_t bytes, std::uint64_t at_first)
{
    if (bytes < bpc_layout::fixed_header) throw Error(ErrorCode::corrupt, {}, "shorter than a chunk's header");
    const std::uint64_t guess = std::min<std::uint64_t>(at_first ? at_first : 65536, bpc_layout::most_header_bytes);
    return ChunkBytes(file, offset, bytes, guess);
}

DecodedChunk decode(ChunkBytes& chunk, std::uint64_t bytes, const ColumnSet& columns,
                    ChunkPositionsMayBe positions_may_be)
{
    DecodedChunk result;
    result.header = decode_known_header(chunk, bytes);
    if (result.header.doubles && positions_may_be == ChunkPositionsMayBe::on_grid)
        throw Error(ErrorCode::unsupported, {}, "its positions are doubles; a chunk on a grid was expected");
    std::vector<std::uint32_t> all(result.header.segments.size());
    std::iota(all.begin(), all.end(), 0u);
    result.bytes_read = result.header.header_bytes;
    result.bytes_read += decode_segments(chunk, result.header, columns, all, result.chunk);
    return result;
}

}  // namespace

DecodedPart read_chunk_part(const ByteSource& file, std::uint64_t offset, std::uint64_t bytes, std::uint64_t at_first,
                            const ColumnSet& columns, const WantedSegment& wanted)
{
    try {
        DecodedPart result;
        ChunkBytes chunk = beginning_of(file, offset, bytes, at_first);
        result.header = decode_known_header(chunk, bytes);
        if (result.header.doubles)
            throw Error(ErrorCode::unsupported, {}, "its positions are doubles; a chunk on a grid was expected");
        for (std::uint32_t s = 0; s < result.header.segments.size(); ++s)
            if (wanted(result.header.segments[s].box, result.header.segments[s].level)) result.kept.push_back(s);
        result.bytes_read = result.header.header_bytes;
        result.bytes_read += decode_segments(chunk, result.header, columns, result.kept, result.chunk);
        return result;
    } catch (const Error& error) {
        rethrow_naming(error, file, offset);
    }
}

DecodedChunk read_chunk(const ByteSource& file, std::uint64_t offset, std::uint64_t bytes, std::uint64_t at_first,
                        const ColumnSet& columns, ChunkPositionsMayBe positions_may_be)
{
    try {
        ChunkBytes chunk = beginning_of(file, offset, bytes, at_first);
        return decode(chunk, bytes, columns, positions_may_be);
    } catch (const Error& error) {
        rethrow_naming(error, file, offset);
    }
}

DecodedChunk decode_chunk(const std::byte* chunk, std::uint64_t bytes, const ByteSource& file, std::uint64_t offset,
                          const ColumnSet& columns)
{
    try {
        ChunkBytes whole(chunk, bytes);
        return decode(whole, bytes, columns, ChunkPositionsMayBe::on_grid);
    } catch (const Error& error) {
        rethrow_naming(error, file, offset);
    }
}

}  // namespace pcm
