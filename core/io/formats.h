// The table of file formats: a format is added here and nowhere else.
//
// A row says how files of a format are named, recognised, opened and written, and what the rest of the project needs to
// know of it. open_reader(), create_writer(), expand_inputs(), convert() and MeshLab's file dialogs read this table;
// the code of a format is in its own folder. The table does not change while the program runs: any thread may read it.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/io/survey.h"
#include "pcm/io/writer.h"

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

// Properties of a format; a row has any number of them, combined with |.
enum FormatTrait : unsigned {
    no_traits = 0,
    needs_grid = 1,           // positions are written as 32-bit integers on a grid: WriteOptions::grid has a meaning
    takes_decimals = 2,       // WriteOptions::decimals has a meaning
    takes_ascii = 4,          // WriteOptions::ascii has a meaning
    asks_layout = 8,          // lines of columns in any layout, which a user may state: ReadOptions::text
    common_extension = 16,    // other kinds of files have the extension too: of a folder only files of points are taken
    unique_structure = 32,    // text that `looks_like` recognises whatever the extension is
    takes_las_version = 64,   // WriteOptions::las_version has a meaning
    takes_colour_bits = 128,  // WriteOptions::colour_bits has a meaning
    takes_float_positions = 256,  // WriteOptions::float_positions has a meaning
};

struct Format {
    // Lower case, without the dot; empty ones are unused.
    std::array<std::string_view, 4> extensions;
    // For people, after the extension: "point cloud (PCL)" is shown as "PCD point cloud (PCL)".
    std::string_view label;
    // A file of this format begins with one of these. Text has none.
    std::array<std::string_view, 4> magic;
    // Text: whether the lines of a file are of this format, by a look at its beginning. Null: only the extension says.
    bool (*looks_like)(const std::filesystem::path& path);
    std::unique_ptr<PointReader> (*open)(const std::filesystem::path& path, const ReadOptions& options);
    // Null: this format is only read.
    std::unique_ptr<PointWriter> (*create)(const std::filesystem::path& path, const FileInfo& cloud,
                                           const WriteOptions& options);
    // What create() should know of the cloud's values, in WriteOptions::survey. Null: nothing.
    SurveyQuestions (*questions)(const FileInfo& cloud, const WriteOptions& options);
    // Whether a file holds points and nothing else, for a format that may also hold meshes. Null: it always does.
    bool (*only_points)(const std::filesystem::path& path);
    unsigned traits;

    bool has(FormatTrait trait) const { return traits & trait; }
    bool is_text() const { return magic[0].empty(); }
    bool has_extension(std::string_view extension) const;  // lower case, without the dot
    bool begins(std::string_view first_bytes) const;       // as one of `magic`
};

// In the order in which file dialogs and messages list them.
const std::vector<Format>& formats();
const Format* format_of_extension(std::string_view extension);  // null when no format has it
const Format* format_of_magic(std::string_view first_bytes);    // null when no format begins like that

// Extensions of all formats with a trait, for messages: ".las and .laz".
std::string extensions_with(FormatTrait trait);

// Files of other programs that are named in messages instead of being taken for damaged point clouds. Recognised by
// `magic`, or by `extension` where there is no magic. With both, the extension is that of one of our formats as well.
struct ForeignFormat {
    std::string_view name;  // "a ZIP archive"
    std::string_view magic;
    std::string_view extension;
};
const ForeignFormat* foreign_format_of_magic(std::string_view first_bytes);    // null when unknown
const ForeignFormat* foreign_format_of_extension(std::string_view extension);  // only those without magic

// "readable are .bpc, .las, ...", the hint of messages about files that are not.
std::string readable_hint();

// First bytes that suffice for all magic; fewer when the file is shorter. Throws Error(not_found | permission | io).
std::string first_bytes_of(const std::filesystem::path& path);

// Whether a file with an extension of ours is a point cloud: false for a mesh (a PLY with faces) and for a foreign
// format of the same extension. True for a file that cannot be read, so that its reader reports what is wrong.
bool is_point_cloud(const std::filesystem::path& path);

}  // namespace pcm
