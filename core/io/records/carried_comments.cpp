#include "pcm/io/records/carried_comments.h"

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/file_text.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>

namespace pcm {
namespace {

constexpr std::size_t longest_text = 200;  // bytes of a name or description; some readers stop at lines of 512 bytes
constexpr std::size_t data_bytes_a_line = 54;
constexpr std::string_view base64_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

bool is_plain(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.' || c == '+';
}

std::string percent_encoded(std::string_view text)
{
    static constexpr char digits[] = "0123456789ABCDEF";
    std::string encoded;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (is_plain(c) || c == '/' || c == ':')
            encoded += c;
        else
            encoded += {'%', digits[byte >> 4], digits[byte & 15]};
    }
    return encoded == "-" ? "%2D" : encoded;
}

std::optional<std::string> percent_decoded(std::string_view text)
{
    std::string decoded;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            decoded += text[i];
            continue;
        }
        unsigned byte = 0;
        if (i + 3 > text.size()) return std::nullopt;
        const char* const end = text.data() + i + 3;
        if (std::from_chars(text.data() + i + 1, end, byte, 16).ptr != end) return std::nullopt;
        decoded += static_cast<char>(byte);
        i += 2;
    }
    return decoded;
}

std::string base64(const std::byte* bytes, std::size_t count)
{
    std::string text;
    for (std::size_t i = 0; i < count; i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < count ? static_cast<std::uint32_t>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k <= count ? base64_digits[bits >> (18 - 6 * k) & 63u] : '=';
    }
    return text;
}

bool append_base64(std::string_view text, std::vector<std::byte>& bytes)
{
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::uint32_t bits = 0;
    unsigned have = 0;
    for (const char c : text) {
        const std::size_t digit = base64_digits.find(c);
        if (digit == std::string_view::npos) return false;
        bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xFFFFu;
        have += 6;
        if (have < 8) continue;
        have -= 8;
        bytes.push_back(static_cast<std::byte>(bits >> have & 255u));
    }
    return true;
}

std::string_view next_word(std::string_view& line)
{
    const std::size_t start = std::min(line.find_first_not_of(" \t\r"), line.size());
    const std::size_t end = std::min(line.find_first_of(" \t\r", start), line.size());
    const std::string_view word = line.substr(start, end - start);
    line.remove_prefix(end);
    return word;
}

template <class T>
bool parse(std::string_view word, T& value)
{
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return !word.empty() && error == std::errc() && stop == word.data() + word.size();
}

std::optional<ScalarType> type_named(std::string_view name)
{
    for (auto type = ScalarType::i8; is_valid(type); type = static_cast<ScalarType>(static_cast<int>(type) + 1))
        if (name_of(type) == name) return type;
    return std::nullopt;
}

std::optional<CarriedAttribute> parse_attribute(std::string_view line)
{
    CarriedAttribute carried;
    Attribute& attribute = carried.attribute;
    carried.field = next_word(line);
    const auto type = type_named(next_word(line));
    if (!type || !parse(next_word(line), attribute.components) || !parse(next_word(line), attribute.scale) ||
        !parse(next_word(line), attribute.offset))
        return std::nullopt;
    const auto name = percent_decoded(next_word(line));
    const std::string_view description = next_word(line);
    const std::string_view step = next_word(line);
    if (!step.empty() && !parse(step, carried.step)) return std::nullopt;
    const auto decoded = percent_decoded(description == "-" ? std::string_view() : description);
    if (!name || !decoded) return std::nullopt;
    attribute.type = *type;
    attribute.name = printable_name(*name);
    attribute.description = printable_name(*decoded);
    if (attribute.name.empty() || attribute.components == 0 || !std::isfinite(attribute.scale) ||
        !std::isfinite(attribute.offset))
        return std::nullopt;
    return carried;
}

std::optional<RepeatedFields> parse_repeated(std::string_view line)
{
    RepeatedFields repeated;
    repeated.field = next_word(line);
    if (!parse(next_word(line), repeated.count)) return std::nullopt;
    repeated.exact = next_word(line);
    return repeated;
}

std::optional<Vec3d> parse_shift(std::string_view line)
{
    Vec3d shift{};
    for (double& s : shift)
        if (!parse(next_word(line), s) || !std::isfinite(s)) return std::nullopt;
    return shift;
}

}  // namespace

std::string field_name(std::string_view name)
{
    std::string word(name.substr(0, longest_text));
    for (char& c : word)
        if (!is_plain(c)) c = '_';
    return word.empty() ? "unnamed" : word;
}

void add_grid(const FileInfo& cloud, std::vector<Metadata>& metadata)
{
    if (!cloud.grid) return;
    const auto is_grid = [](const Metadata& block) { return block.key == "pcm.grid"; };
    metadata.erase(std::remove_if(metadata.begin(), metadata.end(), is_grid), metadata.end());
    const std::string text = exact(cloud.grid->scale) + " " + exact(cloud.grid->offset);
    const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
    metadata.push_back({"pcm.grid", {bytes, bytes + text.size()}});
}

std::optional<Grid> carried_grid(const std::vector<Metadata>& metadata)
{
    for (const Metadata& block : metadata) {
        if (block.key != "pcm.grid") continue;
        std::string_view text(reinterpret_cast<const char*>(block.value.data()), block.value.size());
        Grid grid;
        bool whole = true;
        for (Vec3d* v : {&grid.scale, &grid.offset})
            for (double& number : *v) whole = parse(next_word(text), number) && std::isfinite(number) && whole;
        if (whole && grid.scale[0] > 0 && grid.scale[1] > 0 && grid.scale[2] > 0) return grid;
    }
    return std::nullopt;
}

std::vector<std::string> carried_comments(const Carried& carried, std::vector<std::string>& notes)
{
    std::vector<std::string> lines;
    if (std::string system = crs_comment_line(carried.metadata); !system.empty()) lines.push_back(std::move(system));
    for (const auto& [field, attribute, step] : carried.attributes) {
        std::string description = percent_encoded(attribute.description);
        if (description.size() > longest_text) {
            notes.push_back("the description of attribute '" + attribute.name + "' is too long and is not kept");
            description.clear();
        }
        lines.push_back("pcm attribute " + field + " " + std::string(name_of(attribute.type)) + " " +
                        std::to_string(attribute.components) + " " + exact(attribute.scale) + " " +
                        exact(attribute.offset) + " " + percent_encoded(attribute.name) + " " +
                        (description.empty() ? "-" : description) + (step ? " " + std::to_string(step) : ""));
    }
    for (const auto& [field, count, same] : carried.repeated)
        lines.push_back("pcm repeated " + field + " " + std::to_string(count) + " " + same);
    if (carried.shift) lines.push_back("pcm shift " + exact(*carried.shift));
    std::size_t left = carried_metadata_bytes;
    for (const Metadata& block : carried.metadata) {
        const std::string key = percent_encoded(block.key);
        if (block.value.size() > left || key.size() > longest_text) {
            notes.push_back("metadata '" + block.key + "' of " + std::to_string(block.value.size()) +
                            " bytes are left out: comments hold " + std::to_string(carried_metadata_bytes));
            continue;
        }
        left -= block.value.size();
        lines.push_back("pcm metadata " + (key.empty() ? "-" : key) + " " + std::to_string(block.value.size()));
        for (std::size_t i = 0; i < block.value.size(); i += data_bytes_a_line)
            lines.push_back("pcm data " +
                            base64(block.value.data() + i, std::min(data_bytes_a_line, block.value.size() - i)));
    }
    return lines;
}

Carried read_carried_comments(const std::vector<std::string>& comments, std::vector<std::string>& notes)
{
    Carried carried;
    std::vector<std::size_t> promised;  // bytes of each metadata block
    std::size_t damaged = 0;
    for (const std::string& comment : comments) {
        std::string_view rest = comment;
        if (next_word(rest) != "pcm") continue;
        const std::string_view kind = next_word(rest);
        if (kind == "attribute") {
            auto attribute = parse_attribute(rest);
            if (attribute && carried.attributes.size() < max_attributes)
                carried.attributes.push_back(std::move(*attribute));
            else
                ++damaged;
        } else if (kind == "repeated") {
            auto repeated = parse_repeated(rest);
            if (repeated && carried.repeated.size() < max_attributes)
                carried.repeated.push_back(std::move(*repeated));
            else
                ++damaged;
        } else if (kind == "shift") {
            carried.shift = parse_shift(rest);
            damaged += !carried.shift;
        } else if (kind == "metadata") {
            const std::string_view word = next_word(rest);
            const auto key = percent_decoded(word == "-" ? std::string_view() : word);
            std::size_t bytes = 0;
            if (!key || !parse(next_word(rest), bytes)) {
                ++damaged;
                continue;
            }
            carried.metadata.push_back({*key, {}});
            promised.push_back(bytes);
        } else if (kind == "data") {
            if (carried.metadata.empty() || !append_base64(next_word(rest), carried.metadata.back().value)) ++damaged;
        }
    }
    for (std::size_t i = carried.metadata.size(); i-- > 0;) {
        if (carried.metadata[i].value.size() == promised[i]) continue;
        carried.metadata.erase(carried.metadata.begin() + static_cast<std::ptrdiff_t>(i));
        ++damaged;
    }
    if (damaged)
        notes.push_back(std::to_string(damaged) + " damaged comments about attributes or metadata are ignored");
    return carried;
}

}  // namespace pcm
