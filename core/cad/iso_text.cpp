#include "pcm/cad/iso_text.h"

#include "pcm/system/text.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace pcm {
namespace {

// How many bytes a character of UTF-8 has that begins so.
std::size_t bytes_of(unsigned char first) { return first < 0xc0 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4; }

}  // namespace

std::string iso_characters(std::string& text)
{
    std::string plain;
    std::size_t at = 0;
    while (at < text.size()) {
        const auto first = static_cast<unsigned char>(text[at]);
        const std::size_t bytes = bytes_of(first);
        if (at + bytes > text.size()) break;
        if (first < 0x80) {
            plain += text[at++];
            continue;
        }
        std::uint32_t code = bytes == 1 ? first : first & (0x7fu >> bytes);
        for (std::size_t i = 1; i < bytes; ++i) code = code << 6 | (static_cast<unsigned char>(text[at + i]) & 0x3fu);
        char digits[24];
        std::snprintf(digits, sizeof digits, code < 0x10000 ? "\\X2\\%04X\\X0\\" : "\\X4\\%08X\\X0\\", code);
        plain += digits;
        at += bytes;
    }
    text.erase(0, at);
    return plain;
}

std::string iso_string(const std::string& text)
{
    std::string doubled;
    for (const char c : text) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) continue;
        doubled += c;
        if (c == '\'' || c == '\\') doubled += c;
    }
    return "'" + iso_characters(doubled) + "'";
}

std::string iso_label(const std::string& text)
{
    std::size_t at = 0;
    for (int characters = 0; characters < 255 && at < text.size(); ++characters)
        at += bytes_of(static_cast<unsigned char>(text[at]));
    return iso_string(text.substr(0, at));
}

std::string iso_real(double number)
{
    std::string text = exact(number);
    for (char& c : text)
        if (c == 'e') c = 'E';
    if (text.find('.') == std::string::npos) text.insert(std::min(text.find('E'), text.size()), ".");
    return text;
}

}  // namespace pcm
