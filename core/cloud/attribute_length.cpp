#include "pcm/cloud/attribute_length.h"

#include <algorithm>

namespace pcm {
namespace {

struct Stated {
    std::size_t begin = std::string_view::npos;  // where the unit begins; npos: no unit
    int power = 0;
};

// "source units", and ^ with an exponent of one digit.
Stated find_stated(std::string_view description)
{
    constexpr std::string_view words = attribute_unit::length;
    const std::size_t at = description.rfind(words);
    if (at == std::string_view::npos) return {};
    std::string_view rest = description.substr(at + words.size());
    if (rest.empty()) return {at, 1};
    if (rest[0] != '^') return {};
    rest.remove_prefix(1);
    const bool negative = !rest.empty() && rest[0] == '-';
    if (negative) rest.remove_prefix(1);
    if (rest.size() != 1 || rest[0] < '0' || rest[0] > '9') return {};
    return {at, negative ? -(rest[0] - '0') : rest[0] - '0'};
}

}  // namespace

int length_power(const Attribute& attribute)
{
    const Stated stated = find_stated(attribute.description);
    if (stated.begin != std::string_view::npos) return stated.power;
    const bool known = attribute.name == attribute_name::radius || attribute.name == "mean_distance";
    return known && attribute.components == 1 ? 1 : 0;
}

std::string shortened_description(const std::string& description, std::size_t most)
{
    if (description.size() <= most) return description;
    std::size_t begin = std::min(find_stated(description).begin, description.size());
    while (begin > 0 && (description[begin - 1] == ' ' || description[begin - 1] == ',')) --begin;
    const std::string unit = begin < description.size() ? description.substr(begin) : std::string();
    std::size_t end = most - unit.size();
    const auto continues = [&](std::size_t at) { return (static_cast<unsigned char>(description[at]) & 0xC0) == 0x80; };
    while (end > 0 && continues(end)) --end;
    while (end > 0 && description[end - 1] == ' ') --end;  // readers take spaces at the end away
    return description.substr(0, end) + unit;
}

}  // namespace pcm
