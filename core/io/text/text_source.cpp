#include "pcm/io/text/text_source.h"

#include "pcm/io/text/parse_number.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace pcm {
namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 18;

// The byte after the last line end in [begin, end); null without one. A CR at the very end may be half a line end.
const char* behind_last_line(const char* begin, const char* end)
{
    for (const char* p = end; p != begin; --p)
        if (p[-1] == '\n') return p;
    for (const char* p = end; p != begin; --p)
        if (p[-1] == '\r' && p != end) return p;
    return nullptr;
}

}  // namespace

std::string_view take_line(const char*& at)
{
    const char* const start = at;
    while (!text::is_line_end(*at)) ++at;
    const std::string_view line(start, static_cast<std::size_t>(at - start));
    at += at[0] == '\r' && at[1] == '\n' ? 2 : 1;
    return line;
}

TextSource::TextSource(const File& file, std::uint64_t start, std::uint64_t lines_before)
    : file_(file), next_byte_(start), lines_(lines_before)
{
}

bool TextSource::fill()
{
    while (at_ == end_) {
        if (at_end_ && end_ == held_) return false;
        const std::size_t kept = static_cast<std::size_t>(held_ - at_);
        const bool first = next_byte_ == 0;
        // Grows only for a line longer than a block.
        const std::size_t wanted = std::min(std::max(block_bytes, 2 * kept), longest_text_line + 2);
        if (kept + 2 >= wanted)
            throw Error(ErrorCode::bad_format, file_.path(),
                        "line " + std::to_string(lines_ + 1) + " is longer than " + std::to_string(longest_text_line) +
                            " bytes: this is not a text file of points");
        if (kept) std::memmove(buffer_.data(), at_, kept);
        if (buffer_.size() < wanted) {
            std::vector<char> larger(wanted);
            std::copy_n(buffer_.data(), kept, larger.data());
            buffer_.swap(larger);
        }
        // Two bytes stay free: for a missing line end at the end of the file, and the byte after it.
        const std::size_t got = file_.read_some_at(buffer_.data() + kept, wanted - 2 - kept, next_byte_);
        next_byte_ += got;
        char* held = buffer_.data() + kept + got;
        at_ = buffer_.data();
        if (first && got >= 3 && std::memcmp(at_, "\xEF\xBB\xBF", 3) == 0) at_ += 3;
        at_end_ = got == 0;
        if (at_end_ && at_ != held && held[-1] != '\n' && held[-1] != '\r') {
            *held++ = '\n';
            padding_ = 1;
        }
        *held = '\0';
        held_ = held;
        end_ = at_end_ ? held_ : behind_last_line(at_, held_);
        if (!end_) end_ = at_;
    }
    return true;
}

std::uint64_t TextSource::bytes_read() const
{
    const auto unread = static_cast<std::uint64_t>(held_ - at_);
    return next_byte_ - (unread > padding_ ? unread - padding_ : 0);
}

bool TextSource::next(std::string_view& line)
{
    if (!fill()) return false;
    const char* at = at_;
    line = take_line(at);
    advance(at, 1);
    return true;
}

}  // namespace pcm
