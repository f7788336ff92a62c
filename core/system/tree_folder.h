// The names in a tree's folder, and whether a path leads into one: nothing else may be written among a tree's files,
// and any of them opens the tree. What the files hold is in tree/ and bpc/FORMAT.md.
//
// Paths are compared as the file system sees them: through links, `..` and other spellings. A path may be a URL
// (system/url.h), of which only the names are looked at. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace pcm {

inline constexpr const char* index_file_name = "index.pct";
inline constexpr const char* about_file_name = "about.pct";
inline constexpr const char* lock_file_name = "lock";  // an empty file in the tree's folder; it is never removed
inline constexpr const char* damaged_index_name = "index.pct.damaged";
inline constexpr const char* update_scratch_name = "update.tmp";  // scratch files of an update
inline constexpr const char* build_marker_name = "building";      // in the folder of a build while it is unfinished

// The first bytes of the two files.
inline constexpr char index_magic[8] = {'P', 'C', 'M', 'T', 'R', 'E', 'E', '\n'};
inline constexpr char about_magic[8] = {'P', 'C', 'M', 'A', 'B', 'O', 'U', 'T'};

// Whether a file or folder of this name in a tree's folder belongs to the tree: it is one of the above,
// "chunks-000.bpc" with any number, or the temporary file of one of them.
bool is_name_in_tree(const std::string& name);

// Whether `folder` is a tree's: it has the index or the about.pct of a tree, or, next to data files, damaged ones.
bool is_tree_folder(const std::filesystem::path& folder);

// The tree folder that `path` stands for: the folder of a file that belongs to a tree, such as index.pct or
// chunks-000.bpc, also where `path` is a link to that file. Any other path is returned as it is.
std::filesystem::path tree_folder_of(const std::filesystem::path& path);

// Whether both are the same existing folder, however they are spelt; for URLs, whether they are the same text.
bool same_tree_folder(const std::filesystem::path& a, const std::filesystem::path& b);

// Whether `path` is such a file.
bool is_file_of_tree(const std::filesystem::path& path);

// The nearest folder above `path` that is a tree's or an unfinished build's. `path` need not exist.
std::optional<std::filesystem::path> tree_folder_around(const std::filesystem::path& path);

}  // namespace pcm
