// Attributes and types for the columns of a text file, whose names are from a header (text_header.h), from the user, or
// guessed from the numbers.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/io/text/text_layout.h"
#include "pcm/io/text/text_sample.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

// A column with its name as in TextLayout::columns.
struct TextColumn {
    std::string name;
    std::optional<ScalarType> type;  // if the user stated it
    bool float_colour = false;       // the header says that colours are 0..1
};

// Attributes that LAS defines, and the types it gives them.
struct KnownAttribute {
    std::string_view name;
    ScalarType type;
};
inline constexpr KnownAttribute known_attributes[] = {
    {"classification", ScalarType::u8},
    {"return_number", ScalarType::u8},
    {"number_of_returns", ScalarType::u8},
    {"scan_direction_flag", ScalarType::u8},
    {"edge_of_flight_line", ScalarType::u8},
    {"synthetic", ScalarType::u8},
    {"key_point", ScalarType::u8},
    {"withheld", ScalarType::u8},
    {"overlap", ScalarType::u8},
    {"scanner_channel", ScalarType::u8},
    {"scan_angle_rank", ScalarType::i8},
    {"user_data", ScalarType::u8},
    {"point_source_id", ScalarType::u16},
    {"gps_time", ScalarType::f64},
    {"nir", ScalarType::u16},
};

// Columns of a file without names. The first are x y z. Three others that are unit vectors are normals; three
// with whole numbers up to 255 are colours (also up to 65535, or fractions up to 1, when at most one other column
// remains). A single remaining column is intensity, several are column_4, column_5, ...
std::vector<TextColumn> guess_columns(const std::vector<ColumnLook>& looks, std::uint64_t rows);

struct TextPlan {
    std::vector<TextField> fields;
    Schema schema;
    std::optional<double> colour_range;  // maximum value of a colour: 1, 255 or 65535; null without colours
    std::vector<std::string> notes;
};

// Attributes and types for the columns. r g b become rgb, nx ny nz normal, name_0 name_1 ... one attribute of several
// components. The type is the one that the user stated; else, if all sampled values fit, that of LAS for its attributes
// and u8, u16 or f32 for colours; f32 if all sampled values are floats as printed; i64 or u64 for whole numbers beyond
// the precision of a double; else f64. Whole-numbered intensities are u16 or i16; `signed_intensity` prefers i16, as
// usual in PTS.
TextPlan plan_columns(const std::vector<TextColumn>& columns, const std::vector<ColumnLook>& looks,
                      std::optional<double> colour_range, bool signed_intensity);

}  // namespace pcm
