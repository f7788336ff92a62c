// Characters of UTF-8.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace pcm {

constexpr std::uint32_t not_utf8 = 0xfffd;  // Unicode's replacement character

// The character at `place`, which moves behind it. A byte that begins none (RFC 3629) is `not_utf8` by itself.
std::uint32_t next_character(const std::string& text, std::size_t& place);

}  // namespace pcm
