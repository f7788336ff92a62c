// The lines of a text file, without blank ones, in order.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

// One thread. Memory grows to the longest line; lines beyond 16 MB are refused: Error(bad_format).
class LineStream {
public:
    // `lines_before`: the number of lines before byte `start`. The file must outlive the stream.
    LineStream(const File& file, std::uint64_t start, std::uint64_t lines_before, char line_end = '\n')
        : file_(file), next_byte_(start), line_(lines_before), line_end_(line_end)
    {
    }

    // False at the end of the file. The line, without its end, is valid until the next call.
    bool next(std::string_view& line);
    std::uint64_t line_number() const { return line_; }  // number of the last returned line, counted from 1
    std::uint64_t bytes_consumed() const { return next_byte_ - (end_ - begin_); }

private:
    bool raw_next(std::string_view& line);
    void refill();

    const File& file_;
    std::uint64_t next_byte_;  // offset in the file of the first byte not yet in the buffer
    std::uint64_t line_;
    char line_end_;
    bool at_end_ = false;
    std::vector<char> buffer_;
    std::size_t begin_ = 0, end_ = 0;  // range of the unread part of the buffer
};

// The lines that are left, which are read: "3 lines are ignored, the first is line 12: 'x'"; null when there are none.
std::optional<std::string> describe_rest(LineStream& lines);

}  // namespace pcm
