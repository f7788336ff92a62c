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
    tree += ".part";
    return tree;
}

bool was_being_replaced(const fs::path& tree)
{
    return !name_exists(tree) && name_exists(build_folder_of(tree) / replaced_tree_name);
}

}  // namespace pcm
