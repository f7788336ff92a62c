#include "pcm/system/output_path.h"

#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/system/tree_folder.h"
#include "pcm/system/url.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string_view>
#include <system_error>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr int most_links = 40;  // as Linux follows

fs::file_status status_of_name(const fs::path& path)
{
    std::error_code error;
    const fs::file_status status = fs::symlink_status(path, error);
    if (status.type() == fs::file_type::none) throw Error::from_errno(error.value(), path, "looking at the output");
    return status;
}

// The links in /proc lead to what is already open in a process, not to a name.
void refuse_stream(const fs::path& path, const fs::path& given)
{
    std::error_code error;
    const fs::path folder = fs::canonical(folder_holding(path), error);
    if (!error && folder.string().rfind("/proc/", 0) == 0)
        throw Error(ErrorCode::unsupported, given,
                    "this is an open stream; the output is written to a file, which gets its name when it is whole",
                    "name a file");
}

// Follows the links that the last component is.
fs::path without_links(const fs::path& given)
{
    fs::path path = given;
    for (int links = 0; fs::is_symlink(status_of_name(path)); ++links) {
        refuse_stream(path, given);
        std::error_code error;
        const fs::path target = fs::read_symlink(path, error);
        if (error || links == most_links)
            throw Error::from_errno(error ? error.value() : ELOOP, given, "following the symbolic link");
        path = path.parent_path() / target;
    }
    refuse_stream(path, given);
    return path;
}

const char* name_of(const fs::file_status& status)
{
    switch (status.type()) {
        case fs::file_type::character:
        case fs::file_type::block:
            return "a device";
        case fs::file_type::fifo:
            return "a FIFO";
        case fs::file_type::socket:
            return "a socket";
        default:
            return "no regular file";
    }
}

// A name inside the folder of a tree.
void refuse_inside_tree(const fs::path& path, const fs::path& given)
{
    const std::optional<fs::path> tree = tree_folder_around(path);
    if (!tree) return;
    std::error_code error;
    const bool directly = fs::equivalent(folder_holding(path), *tree, error);
    if (directly && path.filename() == index_file_name)
        throw Error(ErrorCode::invalid_argument, given, "this is the index of the point cloud tree " + tree->string(),
                    "did you mean the tree? Its name is that of the folder, " + tree->filename().string());
    if (directly && is_name_in_tree(path.filename().string()))
        throw Error(ErrorCode::invalid_argument, given, "this is a file of the point cloud tree " + tree->string(),
                    "choose a name outside the tree");
    throw Error(ErrorCode::invalid_argument, given,
                "this is inside the folder of the point cloud tree " + tree->string() +
                    ", which is removed when the tree is replaced",
                "choose a name outside the tree");
}

}  // namespace

fs::path output_file(const fs::path& path)
{
    refuse_to_write(path);
    if (path.empty()) throw Error(ErrorCode::invalid_argument, {}, "the output needs a name");
    const fs::path place = without_links(path);
    const fs::file_status status = status_of_name(place);
    refuse_inside_tree(place, path);
    if (fs::is_directory(status))
        throw Error(ErrorCode::exists, path, "this is a folder; the output is a file", "choose another name");
    if (fs::exists(status) && !fs::is_regular_file(status))
        throw Error(ErrorCode::exists, path,
                    std::string("this is ") + name_of(status) + "; the output is a regular file",
                    "choose another name");
    return place;
}

bool is_point_file_name(const fs::path& path)
{
    // tests/io/formats_test.cpp holds this against the table of formats.
    static constexpr std::array<std::string_view, 13> endings{".bpc", ".las", ".laz", ".pcd", ".ply", ".e57", ".xyz",
                                                              ".txt", ".asc", ".csv", ".pwn", ".pts", ".ptx"};
    std::string ending = path.extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

fs::path output_tree(const fs::path& given)
{
    refuse_to_write(given);
    fs::path path = given;
    if (path.filename().empty()) path = path.parent_path();  // "name.pct/" means name.pct
    if (path.empty()) throw Error(ErrorCode::invalid_argument, {}, "the tree needs a name");
    std::error_code error;
    if (path.filename() == "." || path.filename() == "..") path = fs::canonical(path, error);
    if (error) throw Error::from_errno(error.value(), given, "looking at the output");
    if (!path.has_relative_path())
        throw Error(ErrorCode::invalid_argument, given, "this is the root of the file system, not the name of a tree");
    const fs::path place = without_links(path);
    const fs::file_status status = status_of_name(place);
    refuse_inside_tree(place, given);
    if (!fs::exists(status) && is_point_file_name(path))
        throw Error(ErrorCode::invalid_argument, given,
                    "this is the name of a file (" + path.extension().string() + "), and a tree is a folder",
                    "name the tree " + path.stem().string() + ".pct, and convert that to the file");
    if (!fs::exists(status) && place != path)
        throw Error(ErrorCode::not_found, given,
                    "this is a symbolic link to " + place.string() + ", which does not exist",
                    "remove the link, or choose another name");
    return place;
}

void check_replaceable_tree(const fs::path& path)
{
    std::error_code error;
    if (!fs::is_directory(path, error))
        throw Error(ErrorCode::exists, path, "this is a file, not a point cloud tree, so it is not overwritten",
                    "choose another name");
    if (!is_tree_folder(path))
        throw Error(ErrorCode::exists, path, "this is not a point cloud tree, so it is not overwritten",
                    "choose another name");
    for (const auto& entry : fs::directory_iterator(path, error)) {
        const std::string name = entry.path().filename().string();
        std::error_code ignored;
        if (is_name_in_tree(name) || (name[0] == '.' && !fs::is_directory(entry.symlink_status(ignored)))) continue;
        throw Error(ErrorCode::exists, entry.path(),
                    "this does not belong to the tree that it lies in, and would be removed with it",
                    "move it out of the tree's folder");
    }
    if (error) throw Error::from_errno(error.value(), path, "listing the folder");
}

}  // namespace pcm
