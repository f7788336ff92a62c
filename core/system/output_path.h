// What may be written where: checks of an output's name before anything is written.
//
// Every file that a user names passes output_file() (OutputFile calls it), and every tree output_tree() (BuildFolder
// calls it). Both can be called earlier too, so that a long computation does not end with a name that is refused. Any
// thread.
#pragma once

#include <filesystem>

namespace pcm {

// The place of a file that is to be written as `path`: itself, or what it leads to where it is a symbolic link, so that
// the link stays and its target is written. Whether an existing file may be replaced is for the caller to decide.
// Throws Error(exists | invalid_argument | unsupported) for a URL, a folder, for anything but a regular file (a device,
// a FIFO, a stream such as /dev/stdout), and for a place inside a tree's folder.
std::filesystem::path output_file(const std::filesystem::path& path);

// Whether the name ends as that of a file of points does (.las, .laz, .ply, .pcd, .e57, .xyz, ...), in any case. A tree
// of such a name is a mistake: what was meant is the file.
bool is_point_file_name(const std::filesystem::path& path);

// The same for the folder of a tree. Throws Error(exists) for a file, Error(invalid_argument) for a place inside
// another tree, its index file included, for a link that leads nowhere, and, unless such a folder exists, for the name
// of a file of points. An existing folder is the caller's to judge.
std::filesystem::path output_tree(const std::filesystem::path& path);

// Throws Error(exists) unless the existing folder `path` is a tree and nothing else, so that replacing it loses only
// the tree: files that do not belong to it, but for hidden ones, are named.
void check_replaceable_tree(const std::filesystem::path& path);

}  // namespace pcm
