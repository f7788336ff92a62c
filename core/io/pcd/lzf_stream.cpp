#include "pcm/io/pcd/lzf_stream.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace pcm {
namespace {

constexpr std::size_t farthest_back = 8192;
constexpr std::size_t longest_copy = 264;
constexpr std::size_t longest_instruction = 33;
constexpr std::size_t in_bytes = std::size_t{16} << 10;
constexpr std::size_t out_bytes = farthest_back + (std::size_t{24} << 10);
constexpr std::size_t slack = 32;  // extra size of both buffers, for copies of a fixed size

}  // namespace

void LzfStream::fail(const char* what) const
{
    throw Error(ErrorCode::corrupt, file_->path(), "byte " + std::to_string(position()) + ": " + what);
}

// Keeps the unread bytes, so that an instruction and its literals are in memory together.
void LzfStream::refill()
{
    in_.resize(in_bytes + slack);
    const std::size_t kept = in_end_ - in_at_;
    std::memmove(in_.data(), in_.data() + in_at_, kept);
    const auto more = static_cast<std::size_t>(std::min<std::uint64_t>(in_bytes - kept, end_ - next_byte_));
    in_at_ = 0;
    in_end_ = kept + more;
    file_->read_at(in_.data() + kept, more, next_byte_);
    next_byte_ += more;
}

// Replaces returned bytes, except the last 8192, by new ones.
void LzfStream::decode_some()
{
    out_.resize(out_bytes + slack);
    const std::size_t kept = std::min(decoded_, farthest_back);
    std::memmove(out_.data(), out_.data() + decoded_ - kept, kept);
    std::byte* const out = out_.data();
    std::size_t at = kept;
    while (at + longest_copy <= out_bytes) {
        if (in_end_ - in_at_ < longest_instruction && next_byte_ < end_) refill();
        if (in_at_ == in_end_) break;
        at = decode_from_buffer(out, at);
    }
    decoded_ = at;
    given_ = kept;
    if (at == kept) fail("the compressed data end before the points do");
}

// Decodes until the output is full or the next instruction may not be completely in memory.
std::size_t LzfStream::decode_from_buffer(std::byte* out, std::size_t at)
{
    const std::byte* const in = in_.data();
    const std::size_t end = in_end_, enough = next_byte_ < end_ ? longest_instruction : 1;
    std::size_t i = in_at_;
    const auto fail_here = [&](const char* what) {
        in_at_ = i;
        fail(what);
    };
    while (end - i >= enough && at + longest_copy <= out_bytes) {
        const auto control = static_cast<std::size_t>(in[i]);
        if (control < 32) {
            if (end - i < control + 2) fail_here("the compressed data end within a run of literal bytes");
            std::memcpy(out + at, in + i + 1, 32);
            at += control + 1;
            i += control + 2;
            continue;
        }
        std::size_t length = (control >> 5) + 2;
        const std::size_t used = length == 9 ? 3 : 2;
        if (end - i < used) fail_here("the compressed data end within a reference");
        if (used == 3) length += static_cast<std::size_t>(in[i + 1]);
        const std::size_t back = ((control & 31) << 8) + static_cast<std::size_t>(in[i + used - 1]) + 1;
        if (back > at) fail_here("the compressed data refer to bytes before their beginning");
        std::byte* const to = out + at;
        if (back >= 16)
            for (std::size_t k = 0; k < length; k += 16) std::memcpy(to + k, to + k - back, 16);
        else if (back >= 8)
            for (std::size_t k = 0; k < length; k += 8) std::memcpy(to + k, to + k - back, 8);
        else if (back == 1)
            std::memset(to, static_cast<int>(to[-1]), length);
        else
            for (std::size_t k = at; k < at + length; ++k)
                out[k] = out[k - back];  // overlapping copy: it repeats its own beginning
        at += length;
        i += used;
    }
    in_at_ = i;
    return at;
}

void LzfStream::take(std::byte* to, std::uint64_t count)
{
    while (count) {
        if (given_ == decoded_) decode_some();
        const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(count, decoded_ - given_));
        if (to) {
            std::memcpy(to, out_.data() + given_, now);
            to += now;
        }
        given_ += now;
        count -= now;
    }
}

}  // namespace pcm
