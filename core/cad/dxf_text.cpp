#include "pcm/cad/dxf_text.h"

#include "pcm/cad/utf8.h"

#include <cstdint>
#include <cstdio>

namespace pcm {
namespace {

void append_code(std::string& out, std::uint32_t unit)
{
    char code[16];
    std::snprintf(code, sizeof code, "\\U+%04X", static_cast<unsigned>(unit));
    out += code;
}

std::string without_other_characters(const std::string& utf8)
{
    std::string out;
    for (std::size_t place = 0; place < utf8.size();) {
        const std::uint32_t c = next_character(utf8, place);
        if (c < 0x20 || c == 0x7f) {
            out += ' ';
        } else if (c == not_utf8) {
            out += '?';
        } else if (c < 0x80) {
            out += static_cast<char>(c);
        } else if (c < 0x10000) {
            append_code(out, c);
        } else {  // a pair of UTF-16 units
            append_code(out, 0xd800 + ((c - 0x10000) >> 10));
            append_code(out, 0xdc00 + ((c - 0x10000) & 0x3ff));
        }
    }
    return out;
}

}  // namespace

std::string dxf_text(const std::string& utf8)
{
    std::string out;
    for (const char c : without_other_characters(utf8)) {
        if (c == '^')
            out += "^ ";
        else if (c == '%')
            out += "%%%";
        else
            out += c;
    }
    return out;
}

bool may_be_in_layer_name(char c)
{
    return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f &&
           std::string("<>/\\\":;?*|,=`").find(c) == std::string::npos;
}

std::string dxf_layer_name(const std::string& name)
{
    std::string plain;
    for (const char c : name) plain += may_be_in_layer_name(c) ? c : '_';
    return plain.empty() ? "0" : without_other_characters(plain);
}

}  // namespace pcm
