#include "pcm/cloud/attribute_names.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <charconv>

namespace pcm {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string_view trimmed(std::string_view text)
{
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}
bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::optional<WrittenName> written_name(std::string_view text, std::string_view ends)
{
    std::size_t begin = 0;
    while (begin < text.size() && is_blank(text[begin])) ++begin;
    WrittenName written;
    if (begin == text.size() || (text[begin] != '\'' && text[begin] != '"')) {
        written.end = std::min(text.find_first_of(ends), text.size());
        written.name = trimmed(text.substr(0, written.end));
        return written;
    }
    const std::size_t close = text.find(text[begin], begin + 1);
    if (close == std::string_view::npos) return std::nullopt;
    written.end = std::min(text.find_first_of(ends, close + 1), text.size());
    const std::string_view index = trimmed(text.substr(close + 1, written.end - close - 1));
    if (!index.empty() && (index.front() != '[' || index.back() != ']')) return std::nullopt;
    written.quoted = index.empty();
    written.name = std::string(text.substr(begin + 1, close - begin - 1)) + std::string(index);
    return written;
}

bool is_number(std::string_view text)
{
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    return !text.empty() && result.ec != std::errc::invalid_argument && result.ptr == text.data() + text.size();
}

void check_new_name(const std::string& name)
{
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorCode::invalid_argument, {}, "an attribute cannot be called '" + name + "': " + why,
                    "a name is like height or noise_2: a letter or _ first, then letters, digits, _ - . and blanks");
    };
    if (name.empty()) refuse("the name is empty");
    if (name == "x" || name == "y" || name == "z") refuse("this is a coordinate");
    if (is_number(name)) refuse("this is a number");
    if (!is_letter(name.front())) refuse("it does not begin with a letter");
    if (is_blank(name.back())) refuse("it ends with a blank");
    for (const char c : name)
        if (!is_letter(c) && !is_digit(c) && c != '-' && c != '.' && c != ' ')
            refuse(std::string("it has the character '") + c + "'");
    if (name.find("..") != std::string::npos) refuse("'..' stands for a range of values");
}

}  // namespace pcm
