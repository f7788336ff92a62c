#include "pcm/io/ply/byte_stream.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace pcm {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

}  // namespace

void ByteStream::skip(std::uint64_t bytes)
{
    need(bytes);
    position_ += bytes;
}

void ByteStream::take(std::byte* to, std::size_t bytes)
{
    need(bytes);
    if (position_ < buffer_start_ || position_ + bytes > buffer_start_ + buffer_.size()) {
        buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(buffer_bytes, left())));
        buffer_start_ = position_;
        file_.read_at(buffer_.data(), buffer_.size(), position_);
    }
    std::memcpy(to, buffer_.data() + (position_ - buffer_start_), bytes);
    position_ += bytes;
}

void ByteStream::need(std::uint64_t bytes) const
{
    if (bytes > left())
        throw Error(ErrorCode::truncated, file_.path(),
                    "the file ends at byte " + std::to_string(file_size_) + "; " + std::to_string(bytes) +
                        " bytes were expected from byte " + std::to_string(position_));
}

}  // namespace pcm
