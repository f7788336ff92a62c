// Reads lists of points as text: what .xyz, .txt, .asc, .csv, .pwn and .pts have in common.
#pragma once

#include "pcm/io/reader.h"

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

// What is usual in a format, where a file does not say it itself.
struct TextConventions {
    std::string_view format;           // FileInfo::format; when empty "text separated by ..."
    std::vector<std::string> columns;  // "x y z intensity": the columns of unnamed ones, by their number
    // When not empty, a file with another number of unnamed columns is refused with this hint. Otherwise such columns
    // are guessed from their numbers.
    std::string_view others_refused;
    bool signed_intensity = false;  // whole intensities are i16 rather than u16
};

// The layout is detected (text_sample.h, text_columns.h) where options.text does not set it, and reported in
// info().text_layout and, for people, in info().notes. Positions are doubles, the nearest to the text. Blank lines and
// lines that begin with # // % or ; are skipped; every other line must be a row: Error(bad_format) names the line, what
// it holds and what was expected, unless options.skip_bad_lines counts it instead. Before the first row there may be
// other lines: names of columns (text_header.h), which are refused when x, y and z are not understood, a number of
// points, and titles, which are counted. A line there that seems to be a row is one.
//
// Missing values (text_fields.h) of an attribute are NaN; in a position, and in a column of whole numbers, they are
// faults. Columns of words are not read. Where a header names the columns, lines may have more fields. All of this is
// counted in the notes, which are complete when the whole file has been read.
//
// A line that holds one whole number states the number of rows after it; there may be several such lists. Fewer rows
// are Error(truncated); more are read and noted.
std::unique_ptr<PointReader> open_text(const std::filesystem::path& path, const ReadOptions& options,
                                       const TextConventions& conventions);

// Whether a file whose extension says nothing holds lines of points, by a look at parts of it: nine of ten lines are
// rows of numbers, or there are columns of words too and a header names x, y and z.
bool looks_like_points(const std::filesystem::path& path);

}  // namespace pcm
