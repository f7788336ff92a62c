// Parses lines of numbers into batches: shared by the readers of text formats.
#pragma once

#include "pcm/cloud/point_batch.h"
#include "pcm/io/text/text_fields.h"
#include "pcm/io/text/text_source.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

// The destination of the numbers of one column.
struct TextField {
    enum class Role : std::uint8_t { skipped, axis, attribute, text };  // text: not read, but counted
    std::string name;                                                   // for messages
    Role role = Role::skipped;
    std::size_t index = 0;        // the axis, or the attribute in the schema
    std::uint32_t component = 0;  // component of the attribute
    ScalarType type = ScalarType::f64;
};

struct TextForm {
    TextDialect dialect;
    std::vector<TextField> fields;
    bool longer_lines = false;    // lines may have further fields: not read, but counted
    std::string hint;             // advice to the user when a line does not fit
    bool skip_bad_lines = false;  // lines that are not rows are counted instead of refused
};

// What was skipped or changed, for notes.
struct TextCounts {
    std::uint64_t rows = 0;  // rows read so far
    std::uint64_t longer_lines = 0, first_longer_line = 0;
    std::uint64_t empty_fields = 0;    // read as NaN
    std::uint64_t missing_values = 0;  // marks such as NA, read as NaN
    std::string first_missing;         // and where it is
    std::uint64_t rounded_values = 0;  // with more digits than a 32-bit float keeps
    std::uint64_t bad_lines = 0;       // TextForm::skip_bad_lines
    std::string first_bad_line;        // its number and what is wrong with it
    struct Words {
        std::size_t column = 0;  // counted from 1
        std::string name, first;
        std::uint64_t count = 0;
    };
    std::vector<Words> words;  // fields of TextField::Role::text that are not empty

    // Adds what was counted in later lines of the same file.
    void add(const TextCounts& later);
    std::vector<std::string> notes() const;
};

// One thread.
class TextRows {
public:
    // Called for a line that is not a row with the right number of numbers. True: the line was handled, and reading
    // resumes after it. False: read() throws, or skips the line. It may also throw itself.
    using OddLine = std::function<bool(std::uint64_t line_number, const std::vector<std::string_view>& fields)>;

    TextRows(std::filesystem::path path, TextForm form, OddLine odd_line = {});

    // Reads rows into batch rows first..first+most-1; skips blank lines and comments. Returns the number of rows, which
    // is fewer than `most` only at the end of the file and by the bad lines that it skipped: together they are at most
    // `most`. Throws Error(bad_format) naming the line, what was found and expected.
    std::size_t read(TextSource& source, PointBatch& batch, std::size_t first, std::size_t most);

    const TextCounts& counts() const { return counts_; }

    // The number of rows to prepare memory for: no more than `bytes` can hold, whatever the caller requests.
    std::size_t most_rows(std::uint64_t bytes, std::size_t max_points) const;

private:
    // A field's place in the batch: the value of row i is stored at `to + i * step`.
    struct Slot {
        enum class Kind : std::uint8_t { skipped, i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
        Kind kind = Kind::skipped;
        std::size_t words = none;  // in TextCounts::words, of a field of text
        static constexpr auto none = static_cast<std::size_t>(-1);
        std::byte* to = nullptr;
        std::size_t step = 0;
    };

    void bind(PointBatch& batch, std::size_t first);
    template <bool Blanks>
    const char* plain_row(const char* at, const char* end, std::size_t row);
    // What a line is that plain_row() does not read.
    enum class Line { row, handled, skipped };
    // What is wrong with a line.
    struct Fault {
        std::string what;
        bool bad_line = true;  // false: a number that does not fit the type found for its column
    };
    Line careful_line(std::string_view line, std::size_t row, std::uint64_t line_number);
    std::optional<Fault> careful_row(std::string_view line, std::size_t row, std::uint64_t line_number);
    std::optional<Fault> careful_field(std::string_view word, std::size_t field, std::size_t row,
                                       std::uint64_t line_number);
    void count_word(std::size_t column, std::string_view word);  // counts in TextCounts::words

    std::filesystem::path path_;
    TextForm form_;
    OddLine odd_line_;
    TextCounts counts_;
    std::vector<Slot> slots_;
    std::vector<std::string_view> words_;
    std::vector<std::string_view> pending_;  // the fields of text in the row that is being read
};

}  // namespace pcm
