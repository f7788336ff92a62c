#include "pcm/system/tree_folder.h"

#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/system/url.h"

#include <cstdio>
#include <cstring>
#include <system_error>

namespace pcm {
namespace {

namespace fs = std::filesystem;

bool begins_with(const fs::path& path, const char (&magic)[8])
{
    try {
        char start[sizeof magic];
        return File(path, File::Mode::read).read_some_at(start, sizeof start, 0) == sizeof start &&
               std::memcmp(start, magic, sizeof magic) == 0;
    } catch (const Error&) {
        return false;
    }
}

// A link counts, whatever it leads to; a folder does not.
bool has_file(const fs::path& path)
{
    std::error_code error;
    const fs::file_status status = fs::symlink_status(path, error);
    return fs::exists(status) && !fs::is_directory(status);
}

bool is_data_file_name(const std::string& name)
{
    unsigned number = 0;
    char same[32];
    if (std::sscanf(name.c_str(), "chunks-%9u.bpc", &number) != 1) return false;
    std::snprintf(same, sizeof same, "chunks-%03u.bpc", number);
    return name == same;
}

// The same for a tree behind an address, by its names alone.
fs::path tree_folder_of_url(const fs::path& url)
{
    if (!url.has_filename()) return url.parent_path();
    return is_name_in_tree(url.filename().string()) ? url.parent_path() : url;
}

bool is_build_folder(const fs::path& folder)
{
    return folder.extension() == ".part" && has_file(folder / build_marker_name);
}

}  // namespace

bool is_name_in_tree(const std::string& name)
{
    if (is_data_file_name(name)) return true;
    for (const char* const own : {index_file_name, about_file_name})
        if (name == own || name == std::string(own) + ".new") return true;
    return name == lock_file_name || name == damaged_index_name || name == update_scratch_name;
}

bool is_tree_folder(const fs::path& folder)
{
    const fs::path index = folder / index_file_name, about = folder / about_file_name;
    const bool has_index = has_file(index), has_about = has_file(about);
    if ((has_index && begins_with(index, index_magic)) || (has_about && begins_with(about, about_magic))) return true;
    return (has_index || has_about) && has_file(folder / "chunks-000.bpc");
}

fs::path tree_folder_of(const fs::path& path)
{
    if (is_url(path)) return tree_folder_of_url(path);
    std::error_code error;
    if (fs::is_directory(path, error)) return path;
    // The index names the tree even where there is none, so that errors are about the folder.
    if (path.filename() == index_file_name) return folder_holding(path);
    if (is_name_in_tree(path.filename().string()) && is_tree_folder(folder_holding(path))) return folder_holding(path);
    const fs::path real = fs::canonical(path, error);
    if (!error && is_name_in_tree(real.filename().string()) && is_tree_folder(real.parent_path()))
        return real.parent_path();
    return path;
}

bool same_tree_folder(const fs::path& a, const fs::path& b)
{
    std::error_code error;
    return is_url(a) || is_url(b) ? a == b : fs::equivalent(a, b, error);
}

bool is_file_of_tree(const fs::path& path)
{
    std::error_code error;
    if (fs::is_directory(path, error)) return false;
    const fs::path folder = tree_folder_of(path);
    return folder != path && is_tree_folder(folder);
}

std::optional<fs::path> tree_folder_around(const fs::path& path)
{
    std::error_code error;
    const fs::path given = fs::absolute(path, error);
    fs::path folder = fs::weakly_canonical(folder_holding(given), error);
    if (error) folder = folder_holding(given).lexically_normal();
    for (; folder.has_relative_path(); folder = folder.parent_path())
        if (is_tree_folder(folder) || is_build_folder(folder)) return folder;
    return std::nullopt;
}

}  // namespace pcm
