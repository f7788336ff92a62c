#include "pcm/io/ply/ply_header.h"

#include "pcm/io/file_text.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

namespace pcm {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

std::string_view next_word(std::string_view& line)
{
    const std::size_t start = line.find_first_not_of(blanks);
    if (start == std::string_view::npos) {
        line = {};
        return {};
    }
    const std::size_t end = std::min(line.find_first_of(blanks, start), line.size());
    const std::string_view word = line.substr(start, end - start);
    line.remove_prefix(end);
    return word;
}

std::optional<ScalarType> scalar_type(std::string_view word)
{
    static constexpr std::pair<std::string_view, ScalarType> types[] = {
        {"char", ScalarType::i8},     {"int8", ScalarType::i8},     {"uchar", ScalarType::u8},
        {"uint8", ScalarType::u8},    {"short", ScalarType::i16},   {"int16", ScalarType::i16},
        {"ushort", ScalarType::u16},  {"uint16", ScalarType::u16},  {"int", ScalarType::i32},
        {"int32", ScalarType::i32},   {"uint", ScalarType::u32},    {"uint32", ScalarType::u32},
        {"float", ScalarType::f32},   {"float32", ScalarType::f32}, {"double", ScalarType::f64},
        {"float64", ScalarType::f64}, {"int64", ScalarType::i64},   {"uint64", ScalarType::u64},
    };
    for (const auto& [name, type] : types)
        if (name == word) return type;
    return std::nullopt;
}

class HeaderParser {
public:
    HeaderParser(const File& file, std::string_view text) : file_(file), text_(text) {}

    PlyHeader parse();

private:
    [[noreturn]] void fail(const std::string& what) const
    {
        throw Error(ErrorCode::bad_format, file_.path(), "line " + std::to_string(header_.lines) + ": " + what);
    }
    std::string_view next_line();
    ScalarType type_of(std::string_view word) const;
    void parse_format(std::string_view rest);
    void parse_element(std::string_view rest);
    void parse_property(std::string_view rest);

    const File& file_;
    std::string_view text_;
    PlyHeader header_;
    bool has_format_ = false;
};

std::string_view HeaderParser::next_line()
{
    ++header_.lines;
    const char end = header_.ends_lines_with_cr ? '\r' : '\n';
    const std::string_view rest = text_.substr(static_cast<std::size_t>(header_.bytes));
    const std::size_t length = rest.find(end);
    if (length == std::string_view::npos)
        fail("no 'end_header' in the first " + std::to_string(text_.size()) + " bytes");
    header_.bytes += length + 1;
    return rest.substr(0, length);
}

ScalarType HeaderParser::type_of(std::string_view word) const
{
    const auto type = scalar_type(word);
    if (!type)
        fail("found the type " + quote_bytes(word) + ", expected char, uchar, short, ushort, int, uint, float, double");
    return *type;
}

void HeaderParser::parse_format(std::string_view rest)
{
    const std::string_view name = next_word(rest);
    if (name == "ascii")
        header_.encoding = PlyHeader::Encoding::ascii;
    else if (name == "binary_little_endian")
        header_.encoding = PlyHeader::Encoding::little_endian;
    else if (name == "binary_big_endian")
        header_.encoding = PlyHeader::Encoding::big_endian;
    else
        fail("found the format " + quote_bytes(name) + ", expected ascii, binary_little_endian or binary_big_endian");
    const std::string_view version = next_word(rest);
    if (version != "1.0")
        throw Error(ErrorCode::unsupported, file_.path(),
                    "PLY version " + quote_bytes(version) + " found; 1.0 can be read");
    has_format_ = true;
}

void HeaderParser::parse_element(std::string_view rest)
{
    PlyElement element;
    element.name = next_word(rest);
    const std::string_view count = next_word(rest);
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (element.name.empty() || count.empty() || error != std::errc() || end != count.data() + count.size())
        fail("found the count " + quote_bytes(count) + " of element " + quote_bytes(element.name) +
             ", expected 'element <name> <number>'");
    header_.elements.push_back(std::move(element));
}

void HeaderParser::parse_property(std::string_view rest)
{
    if (header_.elements.empty()) fail("a property comes before the first element");
    PlyProperty property;
    std::string_view word = next_word(rest);
    if (word == "list") {
        property.is_list = true;
        property.count_type = type_of(next_word(rest));
        if (property.count_type == ScalarType::f32 || property.count_type == ScalarType::f64)
            fail("a list has a floating-point length; an integer type was expected");
        word = next_word(rest);
    }
    property.type = type_of(word);
    property.name = printable_name(rest);
    if (property.name.empty()) fail("a property has no name");
    header_.elements.back().properties.push_back(std::move(property));
}

PlyHeader HeaderParser::parse()
{
    // The end of the first line decides how all lines end. A CR before an LF counts as a blank.
    const std::size_t first_end = text_.find_first_of("\r\n");
    header_.ends_lines_with_cr = first_end != std::string_view::npos && text_[first_end] == '\r' &&
                                 (first_end + 1 == text_.size() || text_[first_end + 1] != '\n');
    std::string_view line = next_line();
    if (next_word(line) != "ply") fail("not a PLY file: the first line is not 'ply'");
    for (;;) {
        line = next_line();
        std::string_view rest = line;
        const std::string_view keyword = next_word(rest);
        if (keyword == "end_header") break;
        if (keyword == "comment") {
            std::string_view words = rest;
            if (next_word(words) == "pcm") header_.comments.emplace_back(rest);
            continue;
        }
        if (keyword.empty() || keyword == "obj_info") continue;
        if (keyword == "format")
            parse_format(rest);
        else if (keyword == "element")
            parse_element(rest);
        else if (keyword == "property")
            parse_property(rest);
        else
            fail("found " + quote_bytes(line) +
                 ", expected format, comment, obj_info, element, property or end_header");
    }
    if (!has_format_) fail("the header has no 'format' line");
    return std::move(header_);
}

}  // namespace

bool PlyElement::has_lists() const
{
    for (const PlyProperty& property : properties)
        if (property.is_list) return true;
    return false;
}

std::uint64_t PlyElement::least_bytes() const
{
    std::uint64_t sum = 0;
    for (const PlyProperty& property : properties)
        sum += size_of(property.is_list ? property.count_type : property.type);
    return sum;
}

PlyHeader read_ply_header(const File& file)
{
    // Most headers have some hundred bytes; more is read only when their last line is not among the first bytes.
    const auto holds_last_line = [](const std::string& text, std::size_t bytes) {
        return std::min(text.find("\nend_header"), text.find("\rend_header")) < bytes - 64;
    };
    std::string text;
    for (std::size_t bytes = 4096; bytes <= longest_ply_header; bytes *= 16) {
        text.resize(bytes);
        const std::size_t got = file.read_some_at(text.data(), bytes, 0);
        text.resize(got);
        if (got < bytes || holds_last_line(text, bytes)) break;
    }
    return HeaderParser(file, text).parse();
}

}  // namespace pcm
