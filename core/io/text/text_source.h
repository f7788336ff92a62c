// Reads the lines of a text file, block by block.
#pragma once

#include "pcm/system/file.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace pcm {

inline constexpr std::size_t longest_text_line = std::size_t{1} << 20;

// Lines end with LF, CRLF or CR; a UTF-8 byte order mark is skipped. One thread. Memory is one block, or the longest
// line.
//
// Parsers work on at()..end() directly: whole lines with their line ends (one is added to the last line of a file),
// followed by one more readable byte. They report their progress with advance().
class TextSource {
public:
    // `start` is the first byte of a line, `lines_before` the number of lines before it.
    explicit TextSource(const File& file, std::uint64_t start = 0, std::uint64_t lines_before = 0);

    // Makes sure that an unread line is in memory. False at the end of the file. Throws
    // Error(bad_format) for a line longer than longest_text_line, and Error(io).
    bool fill();

    const char* at() const { return at_; }
    const char* end() const { return end_; }
    // Marks `lines` lines before `to`, the start of a line in at()..end(), as read.
    void advance(const char* to, std::uint64_t lines)
    {
        at_ = to;
        lines_ += lines;
    }

    // The next line without its end, valid until the next call. False at the end of the file.
    bool next(std::string_view& line);

    std::uint64_t lines_read() const { return lines_; }
    std::uint64_t bytes_read() const;

private:
    const File& file_;
    std::uint64_t next_byte_;    // offset in the file of the first byte after the buffer
    std::uint64_t padding_ = 0;  // bytes of the buffer that are not in the file
    std::uint64_t lines_;
    bool at_end_ = false;  // the end of the file is reached
    std::vector<char> buffer_;
    const char* at_ = nullptr;
    const char* end_ = nullptr;   // end of the whole lines
    const char* held_ = nullptr;  // end of all bytes in the buffer
};

// The line that begins at `at`, without its end; moves `at` to the next line. For bytes as TextSource provides them:
// the line has an end, followed by one more byte.
std::string_view take_line(const char*& at);

}  // namespace pcm
