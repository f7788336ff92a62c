#include "pcm/tree/damage.h"

namespace pcm {
namespace {

// Of a text that begins with the error's path: the rest, since Error puts the path in front again.
std::string without_path(const Error& error)
{
    std::string what = error.what();
    const std::string path = error.path().string() + ": ";
    if (!error.path().empty() && what.compare(0, path.size(), path) == 0) what.erase(0, path.size());
    return what;
}

}  // namespace

std::string repair_command(const std::filesystem::path& folder)
{
    const std::string path = folder.string();
    const bool plain = path.find_first_of(" \t'\"\\$&;|<>()*?") == std::string::npos;
    return "pcmlab repair " + (plain ? path : "\"" + path + "\"");
}

bool is_damage(const Error& error)
{
    switch (error.code()) {
        case ErrorCode::corrupt:
        case ErrorCode::truncated:
        case ErrorCode::bad_format:
        case ErrorCode::not_a_tree:
            return true;
        default:
            return false;
    }
}

DamagedTree::DamagedTree(const Error& error, const std::filesystem::path& folder, const std::string& way_out)
    : Error(error.code(), error.path(), without_path(error), way_out + ", in a terminal: " + repair_command(folder)),
      fault_(error.what())
{
}

}  // namespace pcm
