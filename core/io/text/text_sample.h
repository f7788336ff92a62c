// A look at a text file before it is read: how its lines are cut, and what the numbers in its columns are like.
#pragma once

#include "pcm/io/text/text_rows.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// What the sampled values of a column have in common.
struct ColumnLook {
    std::uint64_t values = 0, empty = 0;
    double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
    bool whole = true;                      // all are whole numbers
    bool digits_only = true;                // and written without a fraction
    bool fits_i64 = true, fits_u64 = true;  // and of 64 bits
    bool beyond_double = false;             // an integer that no double holds
    bool single = true;                     // each is what a 32-bit float prints as: reading it as such loses nothing
    std::size_t digits = 0;                 // of the longest
    std::uint64_t unit_vectors = 0;         // rows where this column and the next two are a vector of length 1
    std::uint64_t null_vectors = 0;         // and of length 0

    bool within(double low, double high) const { return values && least >= low && most <= high; }
};

struct TextSample {
    TextDialect dialect;
    std::size_t columns = 0;      // fields of most rows
    std::uint64_t first_row = 0;  // lines before it
    std::uint64_t first_row_byte = 0;
    std::vector<std::string> head;                 // the lines before it
    std::uint64_t rows = 0;                        // that were looked at
    std::uint64_t longer_rows = 0, odd_lines = 0;  // of other lengths; of something else
    double row_bytes = 1;                          // of a row, on average
    std::vector<ColumnLook> looks;                 // one a column

    // Rows of the whole file, about.
    std::uint64_t estimated_rows(std::uint64_t file_size) const;
};

// What the user has said already.
struct TextHints {
    std::optional<char> separator;
    std::optional<std::size_t> skip_lines;
};

// Looks at the first lines, and at pieces of the whole file, a megabyte at most. Nothing if the first lines are not
// rows of three numbers or more, after at most some dozens of other lines (comments apart). Throws Error(bad_format)
// for bytes that are no text, naming the first such byte.
std::optional<TextSample> sample_text(const File& file, const TextHints& hints = {});

// Looks at rows of a known form only: `columns` fields in this dialect, from a byte that begins a line.
TextSample sample_rows(const File& file, const TextDialect& dialect, std::size_t columns, std::uint64_t first_row_byte);

}  // namespace pcm
