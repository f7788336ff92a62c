// Errors and warnings of work in a folder that later gets another name, or is removed: for users.
#pragma once

#include "pcm/system/error.h"

#include <filesystem>
#include <string>

namespace pcm {

// The text with the path `to` wherever it has the path `from`. Any thread.
std::string renamed(std::string text, const std::filesystem::path& from, const std::filesystem::path& to);
// The same for an error's text and path. The result is not is_done() even if the error was.
Error renamed(const Error& error, const std::filesystem::path& from, const std::filesystem::path& to);
// The error's text without its path at the beginning: a new Error puts one in front again. Any thread.
std::string without_path(const Error& error);
// Without its hint at the end, too.
std::string text_alone(const Error& error);

}  // namespace pcm
