#include "pcm/tree/unfinished_build.h"

#include <system_error>

namespace pcm {
namespace {

namespace fs = std::filesystem;

bool name_exists(const fs::path& path)
{
    std::error_code error;
    return fs::exists(fs::symlink_status(path, error));
}

}  // namespace

fs::path build_folder_of(fs::path tree)
{
    if (tree.filename().empty()) tree = tree.parent_path();  // "name.pct/" means name.pct
    tree += ".part";
    return tree;
}

bool was_being_replaced(const fs::path& tree)
{
    // Links are not followed: the folder and the tree in it were made by a build.
    std::error_code error;
    return !name_exists(tree) && fs::is_directory(fs::symlink_status(build_folder_of(tree), error)) &&
           fs::is_directory(fs::symlink_status(build_folder_of(tree) / replaced_tree_name, error));
}

}  // namespace pcm
