#include "pcm/io/formats.h"

#include "pcm/io/bpc/bpc_reader.h"
#include "pcm/io/bpc/bpc_writer.h"
#include "pcm/io/e57/e57_reader.h"
#include "pcm/io/file_text.h"
#include "pcm/io/las/las_reader.h"
#include "pcm/io/las/las_writer.h"
#include "pcm/io/pcd/pcd_reader.h"
#include "pcm/io/pcd/pcd_writer.h"
#include "pcm/io/ply/ply_reader.h"
#include "pcm/io/ply/ply_writer.h"
#include "pcm/io/pts/pts_reader.h"
#include "pcm/io/pts/pts_writer.h"
#include "pcm/io/ptx/ptx_reader.h"
#include "pcm/io/text/text_reader.h"
#include "pcm/io/xyz/xyz_reader.h"
#include "pcm/io/xyz/xyz_writer.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"

#include <algorithm>

namespace pcm {
namespace {

// clang-format off
constexpr Format rows[] = {
//   extensions            label                           first bytes                      structure          open      create      questions      only points      traits
    {{"bpc"},               "binary point cloud",           {"BPCLOUD\n", "BPC1"},           nullptr,           open_bpc, create_bpc, nullptr,       nullptr,         no_traits},
    {{"las"},               "point cloud",                  {"LASF"},                        nullptr,           open_las, create_las, las_questions, nullptr,         needs_grid | takes_las_version},
    {{"laz"},               "point cloud, compressed LAS",  {"LASF"},                        nullptr,           open_las, create_las, las_questions, nullptr,         needs_grid | takes_las_version},
    {{"pcd"},               "point cloud (PCL)",            {"# .PCD", "VERSION "},          nullptr,           open_pcd, create_pcd, pcd_questions, nullptr,         takes_ascii | takes_colour_bits | takes_float_positions},
    {{"ply"},               "point cloud",                  {"ply\n", "ply\r", "ply ", "ply\t"}, nullptr,       open_ply, create_ply, ply_questions, ply_only_points, takes_ascii | takes_colour_bits},
    {{"e57"},               "scans",                        {"ASTM-E57"},                    nullptr,           open_e57, nullptr,    nullptr,       nullptr,         no_traits},
    {{"xyz"},               "points as text",               {},                              looks_like_points, open_xyz, create_xyz, nullptr,       nullptr,         takes_decimals | asks_layout},
    {{"txt", "asc", "csv"}, "points as text",               {},                              looks_like_points, open_xyz, create_xyz, nullptr,       nullptr,         takes_decimals | asks_layout | common_extension},
    {{"pwn"},               "points with normals as text",  {},                              nullptr,           open_pwn, nullptr,    nullptr,       nullptr,         no_traits},
    {{"pts"},               "point cloud (Leica)",          {},                              nullptr,           open_pts, create_pts, nullptr,       nullptr,         takes_decimals},
    {{"ptx"},               "scans (Leica)",                {},                              looks_like_ptx,    open_ptx, nullptr,    nullptr,       nullptr,         unique_structure},
};
// clang-format on

constexpr ForeignFormat foreign[] = {
    {"an Expe point set", "[Expe/PointSet", "pts"},
    {"a ZIP archive", "PK\x03\x04", ""},
    {"gzip data", "\x1f\x8b", ""},
    {"a PDF file", "%PDF", ""},
    {"a PNG picture", "\x89PNG", ""},
    {"Potree data", "POTREE", ""},
    {"an OBJ file", "", "obj"},
    {"an STL file", "", "stl"},
};

bool begins_with(std::string_view text, std::string_view start) { return text.substr(0, start.size()) == start; }

template <class Rows, class Fits>
auto* find(const Rows& list, const Fits& fits)
{
    const auto found = std::find_if(std::begin(list), std::end(list), fits);
    return found == std::end(list) ? nullptr : &*found;
}

}  // namespace

bool Format::has_extension(std::string_view extension) const
{
    return !extension.empty() && std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

bool Format::begins(std::string_view first_bytes) const
{
    return std::any_of(magic.begin(), magic.end(),
                       [&](std::string_view start) { return !start.empty() && begins_with(first_bytes, start); });
}

const std::vector<Format>& formats()
{
    static const std::vector<Format> all(std::begin(rows), std::end(rows));
    return all;
}

const Format* format_of_extension(std::string_view extension)
{
    return find(formats(), [&](const Format& format) { return format.has_extension(extension); });
}

const Format* format_of_magic(std::string_view first_bytes)
{
    return find(formats(), [&](const Format& format) { return format.begins(first_bytes); });
}

std::string extensions_with(FormatTrait trait)
{
    std::vector<std::string> names;
    for (const Format& format : formats())
        for (const std::string_view extension : format.extensions)
            if (format.has(trait) && !extension.empty()) names.push_back("." + std::string(extension));
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
    return text;
}

const ForeignFormat* foreign_format_of_magic(std::string_view first_bytes)
{
    return find(foreign, [&](const ForeignFormat& f) { return !f.magic.empty() && begins_with(first_bytes, f.magic); });
}

const ForeignFormat* foreign_format_of_extension(std::string_view extension)
{
    return find(foreign, [&](const ForeignFormat& f) { return f.magic.empty() && f.extension == extension; });
}

std::string readable_hint()
{
    std::string text;
    for (const std::string& extension : readable_extensions()) text += (text.empty() ? "." : ", .") + extension;
    return "readable are " + text;
}

std::string first_bytes_of(const std::filesystem::path& path)
{
    std::string bytes(16, '\0');
    bytes.resize(File(path, File::Mode::read).read_some_at(bytes.data(), bytes.size(), 0));
    return bytes;
}

bool is_point_cloud(const std::filesystem::path& path)
{
    const std::string extension = extension_of(path);
    const Format* const format = format_of_extension(extension);
    try {
        if (format && format->only_points) return format->only_points(path);
        // Opens the file only where there is a doubt.
        if (!find(foreign, [&](const ForeignFormat& f) { return f.extension == extension; })) return true;
        const ForeignFormat* const other = foreign_format_of_magic(first_bytes_of(path));
        return !other || other->extension != extension;
    } catch (const Error&) {
        return true;
    }
}

}  // namespace pcm
