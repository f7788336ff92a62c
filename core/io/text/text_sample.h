// Examines parts of a text file before it is read: how its lines are split, and what numbers its columns hold.
#pragma once

#include "pcm/io/text/text_rows.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Properties of the sampled values of a column.
struct ColumnLook {
    std::uint64_t values = 0, empty = 0;  // numbers; fields that are empty or stand for a missing value ...
    std::uint64_t marks = 0;              // ... by a mark such as NA
    std::uint64_t words = 0;              // other fields, which the members below do not count
    double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
    bool whole = true;                      // all are whole numbers, ...
    bool digits_only = true;                // ... written without a fraction, ...
    bool fits_i64 = true, fits_u64 = true;  // ... that fit 64 bits
    bool beyond_double = false;             // some integer is not exact as a double
    bool single = true;                     // all are 32-bit floats as printed: reading them as floats loses nothing
    std::size_t digits = 0;                 // length of the longest number
    std::uint64_t unit_vectors = 0;         // rows where this column and the next two are a vector of length 1
    std::uint64_t null_vectors = 0;         // rows where it has length 0

    bool within(double low, double high) const { return values && least >= low && most <= high; }
};

struct TextSample {
    TextDialect dialect;
    std::size_t columns = 0;      // number of fields in most rows
    std::uint64_t first_row = 0;  // number of lines before it
    std::uint64_t first_row_byte = 0;
    std::vector<std::string> head;                 // the lines before the first row: no row, not even a faulty one
    std::uint64_t rows = 0;                        // sampled rows
    std::uint64_t longer_rows = 0, odd_lines = 0;  // rows with more fields; lines that are not rows
    double row_bytes = 1;                          // average length of a row
    std::vector<ColumnLook> looks;                 // one per column

    // Estimated number of rows in the whole file.
    std::uint64_t estimated_rows(std::uint64_t file_size) const;
};

// What the user has stated.
struct TextHints {
    std::optional<char> separator;
    std::optional<std::size_t> skip_lines;
};

// Samples the first lines, and pieces of the whole file: a megabyte at most. Null if no row of three or more numbers is
// found after at most some dozens of other lines (not counting comments and faulty rows). Rows may have columns of
// words too. Throws Error(bad_format) for bytes that are
// not text, naming the first such byte.
std::optional<TextSample> sample_text(const File& file, const TextHints& hints = {});

// Samples only rows of a known form: `columns` fields in this dialect. `first_row_byte` is the start of a line.
TextSample sample_rows(const File& file, const TextDialect& dialect, std::size_t columns, std::uint64_t first_row_byte);

}  // namespace pcm
