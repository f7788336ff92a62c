#include "pcm/io/file_text.h"

#include <utility>

namespace pcm {
namespace {

bool is_continuation(std::string_view text, std::size_t at)
{
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0u) == 0x80u;
}

bool is_utf8(std::string_view text)
{
    for (std::size_t i = 0; i < text.size();) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const std::size_t following = byte < 0x80u                     ? 0
                                      : byte >= 0xC2u && byte <= 0xDFu ? 1
                                      : byte >= 0xE0u && byte <= 0xEFu ? 2
                                      : byte >= 0xF0u && byte <= 0xF4u ? 3
                                                                       : 4;
        if (following == 4) return false;
        for (std::size_t k = 1; k <= following; ++k)
            if (!is_continuation(text, i + k)) return false;
        i += following + 1;
    }
    return true;
}

}  // namespace

std::string printable_name(std::string_view raw)
{
    raw = raw.substr(0, raw.find('\0'));
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
    while (!raw.empty() && blank(raw.front())) raw.remove_prefix(1);
    while (!raw.empty() && blank(raw.back())) raw.remove_suffix(1);

    const bool keep_beyond_ascii = is_utf8(raw);
    std::string name(raw);
    for (char& c : name) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20u || byte == 0x7Fu || (byte >= 0x80u && !keep_beyond_ascii)) c = '_';
    }
    return name;
}

std::string quote_bytes(std::string_view bytes)
{
    static constexpr char digits[] = "0123456789abcdef";
    constexpr std::size_t most = 40;
    std::string text = "'";
    for (const char c : bytes.substr(0, most)) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 0x20 && byte < 0x7F)
            text += c;
        else
            text += {'\\', 'x', digits[byte >> 4], digits[byte & 15]};
    }
    return text + (bytes.size() > most ? "...'" : "'");
}

std::string lower_case(std::string text)
{
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

std::string extension_of(const std::filesystem::path& path)
{
    std::string extension = path.extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    return lower_case(std::move(extension));
}

}  // namespace pcm
