#include "pcm/cad/layer_names.h"

#include "pcm/cad/ascii_text.h"
#include "pcm/cad/dxf_text.h"

#include <cctype>
#include <functional>
#include <unordered_map>
#include <unordered_set>

namespace pcm {
namespace {

constexpr std::size_t longest = 255;

std::string in_capitals(std::string text)
{
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

bool is_inside_a_character(unsigned char c) { return (c & 0xc0) == 0x80; }

// Without its last character of UTF-8.
void shorten(std::string& name)
{
    while (!name.empty() && is_inside_a_character(static_cast<unsigned char>(name.back()))) name.pop_back();
    if (!name.empty()) name.pop_back();
}

std::string without_blanks_around(const std::string& name)
{
    const std::size_t first = name.find_first_not_of(' '), last = name.find_last_not_of(' ');
    return first == std::string::npos ? "_" : name.substr(first, last - first + 1);
}

std::vector<std::string> all_different(const std::vector<std::string>& names, const char* before_number,
                                       const char* behind_number)
{
    std::unordered_set<std::string> taken{"0", "DEFPOINTS"};
    std::unordered_map<std::string, std::size_t> numbers;  // the last one of a name
    std::vector<std::string> result;
    for (const std::string& name : names) {
        std::size_t& number = numbers.emplace(in_capitals(name), 1).first->second;
        std::string one = name;
        while (dxf_layer_name(one).size() > longest) shorten(one);
        while (!taken.insert(in_capitals(one)).second) {
            const std::string end = before_number + std::to_string(++number) + behind_number;
            std::string begin = name;
            while (dxf_layer_name(begin).size() + end.size() > longest) shorten(begin);
            one = begin + end;
        }
        result.push_back(one);
    }
    return result;
}

}  // namespace

std::vector<std::string> layer_names(const std::vector<std::string>& names)
{
    std::vector<std::string> clean;
    for (const std::string& name : names) {
        std::string one;
        for (const char c : name) one += may_be_in_layer_name(c) ? c : '_';
        clean.push_back(without_blanks_around(one));
    }
    return all_different(clean, " (", ")");
}

std::vector<std::string> plain_layer_names(const std::vector<std::string>& names)
{
    std::vector<std::string> clean;
    for (const std::string& name : names) clean.push_back(ascii_text(without_blanks_around(name)));
    return all_different(clean, "_", "");
}

}  // namespace pcm
