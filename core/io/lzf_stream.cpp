#include "io/lzf_stream.h"

#include "cloud/error.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace pcm {
namespace {

constexpr std::size_t farthest_back = 8192;
constexpr std::size_t longest_copy = 264;
constexpr std::size_t in_bytes = std::size_t{16} << 10;
constexpr std::size_t out_bytes = farthest_back + (std::size_t{24} << 10);

}  // namespace

void LzfStream::fail(const char* what) const
{
    throw Error(ErrorCode::corrupt, file_->path(), "byte " + std::to_string(position()) + ": " + what);
}

// Keeps what is unread, so that an instruction and its literals are in memory as a whole.
void LzfStream::refill()
{
    const std::size_t kept = in_.size() - in_at_;
    if (kept) std::memmove(in_.data(), in_.data() + in_at_, kept);
    const auto more = static_cast<std::size_t>(std::min<std::uint64_t>(in_bytes - kept, end_ - next_byte_));
    in_.resize(kept + more);
    in_at_ = 0;
    file_->read_at(in_.data() + kept, more, next_byte_);
    next_byte_ += more;
}

// Replaces the bytes given by new ones, behind the last 8192 of them.
void LzfStream::decode_some()
{
    out_.resize(out_bytes);
    const std::size_t kept = std::min(decoded_, farthest_back);
    std::memmove(out_.data(), out_.data() + decoded_ - kept, kept);
    std::size_t at = kept;
    while (at + longest_copy <= out_bytes) {
        if (in_.size() - in_at_ < 33 && next_byte_ < end_) refill();
        const std::size_t left = in_.size() - in_at_;
        if (left == 0) break;
        const std::byte* from = in_.data() + in_at_;
        const auto control = static_cast<std::size_t>(from[0]);
        if (control < 32) {
            if (left < control + 2) fail("the compressed data end within a run of literal bytes");
            std::memcpy(out_.data() + at, from + 1, control + 1);
            at += control + 1;
            in_at_ += control + 2;
            continue;
        }
        std::size_t length = control >> 5, used = 2;
        if (length == 7) {
            if (left < 3) fail("the compressed data end within a reference");
            length += static_cast<std::size_t>(from[1]);
            used = 3;
        }
        if (left < used) fail("the compressed data end within a reference");
        const std::size_t back = ((control & 31) << 8) + static_cast<std::size_t>(from[used - 1]) + 1;
        if (back > at) fail("the compressed data refer to what lies before their beginning");
        length += 2;
        std::byte* const to = out_.data() + at;
        if (back >= length)
            std::memcpy(to, to - back, length);
        else if (back == 1)
            std::memset(to, static_cast<int>(to[-1]), length);
        else
            for (std::size_t i = at; i < at + length; ++i) out_[i] = out_[i - back];  // what is copied may be its own copy
        at += length;
        in_at_ += used;
    }
    decoded_ = at;
    given_ = kept;
    if (at == kept) fail("the compressed data end before the points do");
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
