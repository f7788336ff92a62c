#include "pcm/bpc/chunk_bytes.h"

#include "pcm/bpc/column_codec.h"
#include "pcm/bpc/layout.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace pcm {
namespace {

std::unique_ptr<std::byte[]> room_for(std::uint64_t bytes)
{
    std::unique_ptr<std::byte[]> room(new std::byte[static_cast<std::size_t>(bytes) + codec_slack]);
    std::memset(room.get() + bytes, 0, codec_slack);
    return room;
}

// The length of the header that begins with these bytes; 0 where no chunk begins.
std::uint32_t stated_header_bytes(const std::byte* bytes, std::uint64_t size)
{
    std::uint32_t header_bytes = 0;
    if (size >= bpc_layout::header_bytes_at + sizeof header_bytes && std::memcmp(bytes, bpc_layout::magic, 4) == 0)
        std::memcpy(&header_bytes, bytes + bpc_layout::header_bytes_at, sizeof header_bytes);
    return header_bytes;
}

}  // namespace

ChunkBytes::ChunkBytes(const ByteSource& file, std::uint64_t offset, std::uint64_t available, std::uint64_t at_first)
    : file_(&file), offset_(offset), beginning_size_(std::min(available, at_first))
{
    head_ = room_for(beginning_size_);
    file.read_at(head_.get(), static_cast<std::size_t>(beginning_size_), offset);
    const std::uint32_t header_bytes = stated_header_bytes(head_.get(), beginning_size_);
    if (header_bytes > beginning_size_ && header_bytes <= available && header_bytes <= bpc_layout::most_header_bytes) {
        std::unique_ptr<std::byte[]> longer = room_for(header_bytes);
        std::memcpy(longer.get(), head_.get(), static_cast<std::size_t>(beginning_size_));
        file.read_at(longer.get() + beginning_size_, static_cast<std::size_t>(header_bytes - beginning_size_),
                     offset + beginning_size_);
        head_ = std::move(longer);
        beginning_size_ = header_bytes;
    }
    beginning_ = head_.get();
}

const std::byte* ChunkBytes::get(std::uint64_t start, std::uint64_t bytes)
{
    const std::uint64_t end = start + bytes;
    if (end <= beginning_size_) return beginning_ + start;
    if (!file_) throw Error(ErrorCode::truncated, {}, "it ends before its columns do");
    if (more_size_ < bytes) {
        more_ = room_for(bytes);
        more_size_ = bytes;
    }
    const std::uint64_t known = start < beginning_size_ ? beginning_size_ - start : 0;
    if (known > 0) std::memcpy(more_.get(), beginning_ + start, static_cast<std::size_t>(known));
    file_->read_at(more_.get() + known, static_cast<std::size_t>(bytes - known), offset_ + start + known);
    return more_.get();
}

[[noreturn]] void rethrow_naming(const Error& error, const ByteSource& file, std::uint64_t offset)
{
    if (!error.path().empty()) throw;
    throw Error(error.code(), file.path(), "chunk at byte " + std::to_string(offset) + ": " + error.what());
}

}  // namespace pcm
