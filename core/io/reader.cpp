#include "io/reader.h"

#include "cloud/file.h"
#include "io/bpc_reader.h"
#include "io/e57_reader.h"
#include "io/las_reader.h"
#include "io/names.h"
#include "io/pcd_reader.h"
#include "io/ply_reader.h"

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

// Readers that have nothing to choose.
template <std::unique_ptr<PointReader> (*open)(const std::filesystem::path&)>
std::unique_ptr<PointReader> plainly(const std::filesystem::path& path, const ReadOptions&)
{
    return open(path);
}

// The registry: a format is added here and nowhere else.
constexpr Format formats[] = {
    {"bpc", begins_like_bpc, plainly<open_bpc>},
    {"las", begins_like_las, open_las},
    {"laz", begins_like_las, open_las},
    {"pcd", begins_like_pcd, plainly<open_pcd>},
    {"ply", begins_like_ply, plainly<open_ply>},
    {"e57", begins_like_e57, plainly<open_e57>},
};

struct ForeignFormat {
    std::string_view start;
    std::string_view name;
};
constexpr ForeignFormat foreign_formats[] = {
    {"[Expe/PointSet", "an Expe point set"},
    {"PK\x03\x04", "a ZIP archive"}, {"\x1f\x8b", "gzip data"}, {"%PDF", "a PDF file"},
    {"\x89PNG", "a PNG picture"},    {"POTREE", "Potree data"},
};
constexpr std::pair<std::string_view, std::string_view> foreign_extensions[] = {
    {"pts", "a PTS file"},
    {"ptx", "a PTX file"},  {"xyz", "an XYZ file"}, {"txt", "a text file"}, {"csv", "a text file"},
    {"obj", "an OBJ file"}, {"stl", "an STL file"},
};

std::string list_of_extensions()
{
    std::string text;
    for (const Format& format : formats) text += (text.empty() ? "." : ", .") + std::string(format.extension);
    return text;
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
                        "this is " + std::string(foreign.name) + ": at byte 0 stands " + quote_bytes(foreign.start), readable);

    const std::string extension = extension_of(path);
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
    const std::vector<std::string> extensions = readable_extensions();
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
            if (entry->is_regular_file(unknown) &&
                std::find(extensions.begin(), extensions.end(), extension_of(entry->path())) != extensions.end())
                inside.push_back(entry->path());
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
