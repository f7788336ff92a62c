// A number of things in words.
#pragma once

#include <cstdint>
#include <string>

namespace pcm {

std::string counted(std::uint64_t number, const std::string& noun);  // "1 pipe", "1,234 pipes"
// With what follows: "1 pipe is hidden", "2 pipes are hidden".
std::string counted(std::uint64_t number, const std::string& noun, const std::string& one, const std::string& several);

}  // namespace pcm
