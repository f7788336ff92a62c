// A number of things in words.
#pragma once

#include <cstdint>
#include <string>

namespace pcm {

std::string counted(std::uint64_t number, const std::string& noun);  // "1 pipe", "1,234 pipes"

}  // namespace pcm
