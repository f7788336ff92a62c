// Parses lines of numbers into batches: shared by the readers of text formats.
#pragma once

#include "pcm/cloud/point_batch.h"
#include "pcm/io/text/text_source.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

// How a line is split into fields.
struct TextDialect {
    char separator =
        ' ';           // ' ': any run of blanks and tabs; otherwise ',' ';' '\t', and fields may be padded and quoted
    char point = '.';  // of decimal numbers
    bool operator==(const TextDialect& o) const { return separator == o.separator && point == o.point; }
};

// Fields without padding and quotes. A separator at the end of a line is followed by one more, empty field.
void split_fields(std::string_view line, const TextDialect& dialect, std::vector<std::string_view>& fields);

// An empty line, or one that begins with # // or %.
bool is_blank_or_comment(std::string_view line);

// The destination of the numbers of one column.
struct TextField {
    enum class Role : std::uint8_t { skipped, axis, attribute };
    std::string name;  // for messages
    Role role = Role::skipped;
    std::size_t index = 0;        // the axis, or the attribute in the schema
    std::uint32_t component = 0;  // of the attribute
    ScalarType type = ScalarType::f64;
};

struct TextForm {
    TextDialect dialect;
    std::vector<TextField> fields;
    bool longer_lines = false;  // lines may have further fields: not read, but counted
    std::string hint;           // advice to the user when a line does not fit
};

// What was skipped or changed, for notes.
struct TextCounts {
    std::uint64_t rows = 0;  // read so far
    std::uint64_t longer_lines = 0, first_longer_line = 0;
    std::uint64_t empty_fields = 0;    // read as NaN
    std::uint64_t rounded_values = 0;  // with more digits than a 32-bit float keeps

    std::vector<std::string> notes() const;
};

// One thread.
class TextRows {
public:
    // Called for a line that is not a row with the right number of numbers. True: the line was handled, and reading
    // resumes after it. False: read() throws. It may also throw itself.
    using OddLine = std::function<bool(std::uint64_t line_number, const std::vector<std::string_view>& fields)>;

    TextRows(std::filesystem::path path, TextForm form, OddLine odd_line = {});

    // Reads rows into batch rows first..first+most-1; skips blank lines and comments. Returns the number of rows: fewer
    // than `most` only at the end of the file. Throws Error(bad_format) naming the line, what was found and expected.
    std::size_t read(TextSource& source, PointBatch& batch, std::size_t first, std::size_t most);

    const TextCounts& counts() const { return counts_; }

    // The number of rows to prepare memory for: no more than `bytes` can hold, whatever the caller requests.
    std::size_t most_rows(std::uint64_t bytes, std::size_t max_points) const;

private:
    // A field's place in the batch: the value of row i is stored at `to + i * step`.
    struct Slot {
        enum class Kind : std::uint8_t { skipped, i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
        Kind kind = Kind::skipped;
        std::byte* to = nullptr;
        std::size_t step = 0;
    };

    void bind(PointBatch& batch, std::size_t first);
    template <bool Blanks>
    const char* plain_row(const char* at, const char* end, std::size_t row);
    bool careful_row(std::string_view line, std::size_t row, std::uint64_t line_number);
    void careful_field(std::string_view word, std::size_t field, std::size_t row, std::string_view line,
                       std::uint64_t line_number);
    [[noreturn]] void fail(std::uint64_t line_number, const std::string& what) const;

    std::filesystem::path path_;
    TextForm form_;
    OddLine odd_line_;
    TextCounts counts_;
    std::vector<Slot> slots_;
    std::vector<std::string_view> words_;
};

}  // namespace pcm
