#include "pcm/io/records/line_stream.h"

#include "pcm/io/file_text.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace pcm {
namespace {

constexpr std::size_t least_buffer_bytes = std::size_t{256} << 10;
constexpr std::size_t longest_line = std::size_t{16} << 20;

}  // namespace

bool LineStream::next(std::string_view& line)
{
    while (raw_next(line))
        if (line.find_first_not_of(" \t\r\v\f") != std::string_view::npos) return true;
    return false;
}

bool LineStream::raw_next(std::string_view& line)
{
    std::size_t searched = 0;
    for (;;) {
        const char* const start = buffer_.data() + begin_;
        const void* const found =
            end_ > begin_ + searched ? std::memchr(start + searched, line_end_, end_ - begin_ - searched) : nullptr;
        if (found) {
            line = {start, static_cast<std::size_t>(static_cast<const char*>(found) - start)};
            begin_ += line.size() + 1;
            ++line_;
            return true;
        }
        searched = end_ - begin_;
        if (at_end_) {
            if (searched == 0) return false;
            line = {start, searched};
            begin_ = end_;
            ++line_;
            return true;
        }
        refill();
    }
}

void LineStream::refill()
{
    const std::size_t kept = end_ - begin_;
    if (kept >= longest_line)
        throw Error(ErrorCode::bad_format, file_.path(),
                    "line " + std::to_string(line_ + 1) + " is longer than " + std::to_string(longest_line) + " bytes");
    if (kept) std::memmove(buffer_.data(), buffer_.data() + begin_, kept);
    buffer_.resize(std::max(kept * 2, least_buffer_bytes));
    const std::size_t got = file_.read_some_at(buffer_.data() + kept, buffer_.size() - kept, next_byte_);
    at_end_ = got == 0;
    next_byte_ += got;
    begin_ = 0;
    end_ = kept + got;
}

std::optional<std::string> describe_rest(LineStream& lines)
{
    std::string_view line;
    std::uint64_t count = 0, first_number = 0;
    std::string first, more;
    try {
        while (lines.next(line)) {
            if (count++) continue;
            first = quote_bytes(line);
            first_number = lines.line_number();
        }
    } catch (const Error& error) {
        if (error.code() != ErrorCode::bad_format) throw;
        if (count == 0) return "bytes after the last point, which are not lines of text, are ignored";
        more = " and more";
    }
    if (count == 0) return std::nullopt;
    return grouped(count) + (count == 1 ? " line" : " lines") + more + " after the last point" +
           (count == 1 && more.empty() ? " is" : " are") + " ignored, the first is line " +
           std::to_string(first_number) + ": " + first;
}

}  // namespace pcm
