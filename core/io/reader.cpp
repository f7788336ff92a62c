#include "pcm/io/reader.h"

#include "pcm/system/file.h"
#include "pcm/io/bpc/bpc_reader.h"
#include "pcm/io/e57/e57_reader.h"
#include "pcm/io/las/las_reader.h"
#include "pcm/io/names.h"
#include "pcm/io/pcd/pcd_reader.h"
#include "pcm/io/ply/ply_reader.h"
#include "pcm/io/text/ptx_reader.h"
#include "pcm/io/text/xyz_reader.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace pcm {
namespace {

struct Format {
    std::string_view extension;
    bool (*begins)(std::string_view start);  // whether a file's first bytes say so
    std::unique_ptr<PointReader> (*open)(const std::filesystem::path& path, const ReadOptions& options);
};

bool begins_with(std::string_view text, std::string_view start) { return text.substr(0, start.size()) == start; }

// A cloud's block, or a chunk as trees have them.
bool begins_like_bpc(std::string_view start) { return begins_with(start, "BPCLOUD\n") || begins_with(start, "BPC1"); }

bool begins_like_las(std::string_view start) { return begins_with(start, "LASF"); }

bool begins_like_e57(std::string_view start) { return begins_with(start, "ASTM-E57"); }

bool begins_like_ply(std::string_view start)
{
    return begins_with(start, "ply") && start.size() > 3 &&
           std::string_view("\n\r \t").find(start[3]) != std::string_view::npos;
}

bool begins_like_pcd(std::string_view start) { return begins_with(start, "# .PCD") || begins_with(start, "VERSION "); }

// Text has no magic bytes: see open_text().
bool never(std::string_view) { return false; }

// Readers that have nothing to choose.
template <std::unique_ptr<PointReader> (*open)(const std::filesystem::path&)>
std::unique_ptr<PointReader> plainly(const std::filesystem::path& path, const ReadOptions&)
{
    return open(path);
}

// The registry: a format is added here and nowhere else.
constexpr Format formats[] = {
    {"bpc", begins_like_bpc, open_bpc},
    {"las", begins_like_las, open_las},
    {"laz", begins_like_las, open_las},
    {"pcd", begins_like_pcd, plainly<open_pcd>},
    {"ply", begins_like_ply, plainly<open_ply>},
    {"e57", begins_like_e57, plainly<open_e57>},
    {"xyz", never, open_xyz},
    {"txt", never, open_xyz},
    {"asc", never, open_xyz},
    {"csv", never, open_xyz},
    {"pwn", never, open_xyz},
    {"pts", never, open_pts},
    {"ptx", never, open_ptx},
};

struct ForeignFormat {
    std::string_view start;
    std::string_view name;
};
constexpr ForeignFormat foreign_formats[] = {
    {"[Expe/PointSet", "an Expe point set"},
    {"PK\x03\x04", "a ZIP archive"},
    {"\x1f\x8b", "gzip data"},
    {"%PDF", "a PDF file"},
    {"\x89PNG", "a PNG picture"},
    {"POTREE", "Potree data"},
};
constexpr std::pair<std::string_view, std::string_view> foreign_extensions[] = {
    {"obj", "an OBJ file"},
    {"stl", "an STL file"},
};

std::string list_of_extensions()
{
    std::string text;
    for (const Format& format : formats) text += (text.empty() ? "." : ", .") + std::string(format.extension);
    return text;
}

bool is_text(std::string_view extension)
{
    for (const Format& format : formats)
        if (extension == format.extension) return format.begins == never;
    return false;
}

bool is_format(std::string_view extension)
{
    return std::any_of(std::begin(formats), std::end(formats),
                       [&](const Format& format) { return extension == format.extension; });
}

// Text by its structure: the lines before a PTX scan are like no other; else, where the extension says nothing, lines
// of points. Null when it is neither.
std::unique_ptr<PointReader> open_text(const std::filesystem::path& path, const ReadOptions& options,
                                       std::string_view extension)
{
    if (is_format(extension) && !is_text(extension)) return nullptr;
    if (looks_like_ptx(path)) return open_ptx(path, options);
    if (!is_text(extension) && looks_like_points(path)) return open_xyz(path, options);
    return nullptr;
}

// Whether a file in a folder is meant: what is called .txt or .csv may well be something else.
bool is_cloud_of_folder(const std::filesystem::path& path)
{
    const std::string extension = extension_of(path);
    if (extension == "txt" || extension == "csv" || extension == "asc")
        return looks_like_points(path) || looks_like_ptx(path);
    return is_format(extension);
}

std::filesystem::file_status status_of(const std::filesystem::path& path)
{
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found)
        throw Error(ErrorCode::not_found, path, "no such file or folder");
    if (error) throw Error::from_errno(error.value(), path, "looking at it");
    return status;
}

}  // namespace

void PointReader::seek(std::uint64_t)
{
    throw Error(ErrorCode::unsupported, {}, "points of this format can only be read in order");
}

std::unique_ptr<PointReader> open_reader(const std::filesystem::path& path, const ReadOptions& options)
{
    // Asked before opening: opening a pipe would wait for its other end.
    const std::filesystem::file_status status = status_of(path);
    if (std::filesystem::is_directory(status))
        throw Error(ErrorCode::unsupported, path, "this is a folder; a point cloud file was expected");
    if (!std::filesystem::is_regular_file(status))
        throw Error(ErrorCode::unsupported, path, "this is not a regular file");

    std::array<char, 16> buffer{};
    const std::size_t got = File(path, File::Mode::read).read_some_at(buffer.data(), buffer.size(), 0);
    const std::string_view start(buffer.data(), got);
    for (const Format& format : formats)
        if (format.begins(start)) return format.open(path, options);

    const std::string readable = "readable are " + list_of_extensions();
    if (start.empty()) throw Error(ErrorCode::bad_format, path, "the file is empty", readable);
    for (const ForeignFormat& foreign : foreign_formats)
        if (begins_with(start, foreign.start))
            throw Error(ErrorCode::unsupported, path,
                        "this is " + std::string(foreign.name) + ": at byte 0 stands " + quote_bytes(foreign.start),
                        readable);

    const std::string extension = extension_of(path);
    if (auto text = open_text(path, options, extension)) return text;
    for (const Format& format : formats)
        if (extension == format.extension) return format.open(path, options);  // says what it expected
    for (const auto& [known, name] : foreign_extensions)
        if (extension == known) throw Error(ErrorCode::unsupported, path, "this is " + std::string(name), readable);
    throw Error(ErrorCode::bad_format, path, "no known point cloud format: the file begins with " + quote_bytes(start),
                readable);
}

std::vector<std::string> readable_extensions()
{
    std::vector<std::string> extensions;
    for (const Format& format : formats) extensions.emplace_back(format.extension);
    return extensions;
}

std::vector<std::filesystem::path> expand_inputs(const std::vector<std::filesystem::path>& inputs)
{
    std::vector<std::filesystem::path> files;
    for (const std::filesystem::path& input : inputs) {
        if (!std::filesystem::is_directory(status_of(input))) {
            files.push_back(input);
            continue;
        }
        std::vector<std::filesystem::path> inside;
        std::error_code error;
        std::filesystem::directory_iterator entry(input, error);
        for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
            std::error_code unknown;
            if (entry->is_regular_file(unknown) && is_cloud_of_folder(entry->path())) inside.push_back(entry->path());
        }
        if (error) throw Error::from_errno(error.value(), input, "listing the folder");
        if (inside.empty())
            throw Error(ErrorCode::not_found, input, "the folder holds no file with a readable extension",
                        "readable are " + list_of_extensions());
        std::sort(inside.begin(), inside.end());
        files.insert(files.end(), inside.begin(), inside.end());
    }
    return files;
}

}  // namespace pcm
