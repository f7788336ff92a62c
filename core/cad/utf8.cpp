#include "pcm/cad/utf8.h"

namespace pcm {

std::uint32_t next_character(const std::string& text, std::size_t& place)
{
    const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
    const std::uint32_t first = byte(place++);
    if (first < 0x80) return first;
    const std::size_t more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : first >= 0xc2 ? 1 : 0;
    if (!more || first > 0xf4 || place + more > text.size()) return not_utf8;
    std::uint32_t character = first & (0x3fu >> more);
    for (std::size_t i = 0; i < more; ++i) {
        if ((byte(place + i) & 0xc0) != 0x80) return not_utf8;
        character = character << 6 | (byte(place + i) & 0x3f);
    }
    place += more;
    return character;
}

}  // namespace pcm
