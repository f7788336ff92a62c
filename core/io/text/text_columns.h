// What the columns of a text file mean: by the names in a header, by the user's word, or by how the numbers look.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/io/text/text_layout.h"
#include "pcm/io/text/text_sample.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// A column by its name in TextLayout's vocabulary.
struct TextColumn {
    std::string name;
    std::optional<ScalarType> type;  // when somebody has said it
    bool float_colour = false;       // the header says that colours are 0..1
};

// The columns that a header line names, null when the line names no x, y and z: names in any case, between the
// dialect's separators or others, quoted or not, behind # or // or not, in the words of common programs (Easting, Red,
// scalar_Intensity, NormalX, GpsTime, ...). Names without a meaning are kept as they are.
std::optional<std::vector<TextColumn>> header_columns(const std::string& line, const TextDialect& dialect);

// Whether a line that is no header tries to be one: it names an axis but not all three once. For a clear refusal.
bool is_half_a_header(const std::string& line, const TextDialect& dialect);

// Columns of a file without names: x y z first; then three that are unit vectors are normals, three whole numbers up to
// 255 colours (or up to 65535, or fractions up to 1, when no more than one other is left); a single one left over is
// intensity, several are column_4, column_5, ...
std::vector<TextColumn> guess_columns(const std::vector<ColumnLook>& looks, std::uint64_t rows);

struct TextPlan {
    std::vector<TextField> fields;
    Schema schema;
    std::optional<double> colour_range;  // largest value of a colour: 1, 255 or 65535; null without colours
    std::vector<std::string> notes;
};

// Attributes and types for the columns. Three of r g b become rgb, of nx ny nz normal, name_0 name_1 ... one attribute
// of several components. Types: what the user said; LAS's own for its attributes and u8, u16 or f32 for colours where
// all sampled values fit; f32 where all sampled values are what floats print as; i64 or u64 for whole numbers that no
// double holds; else f64. Intensities that are whole numbers are u16 or i16; `signed_intensity` prefers i16, as PTS has
// it.
TextPlan plan_columns(const std::vector<TextColumn>& columns, const std::vector<ColumnLook>& looks,
                      std::optional<double> colour_range, bool signed_intensity);

}  // namespace pcm
