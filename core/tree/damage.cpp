#include "pcm/tree/damage.h"

#include "pcm/system/renamed_error.h"
#include "pcm/system/url.h"

#include <algorithm>
#include <cstring>

namespace pcm {
namespace {

// As a shell takes it for one word: quoted unless all of its characters stand for themselves.
std::string shell_word(const std::string& text)
{
    const auto is_plain = [](char c) {
        const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c & 0x80);
        return is_letter || (c >= '0' && c <= '9') || std::strchr("/._-+,:@%=", c);
    };
    if (std::all_of(text.begin(), text.end(), is_plain)) return text;
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return word + "'";
}

}  // namespace

std::string repair_command(const std::filesystem::path& folder)
{
    const std::string path = folder.string();
    return "pcmlab repair " + shell_word(path[0] == '-' ? "./" + path : path);
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
    : Error(error.code(), error.path(), without_path(error),
            is_url(folder) ? "put the tree on the server again; one on a disk can be repaired"
                           : way_out + ", in a terminal: " + repair_command(folder)),
      fault_(error.what())
{
}

}  // namespace pcm
