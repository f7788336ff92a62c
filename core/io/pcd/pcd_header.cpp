#include "pcm/io/pcd/pcd_header.h"

#include "pcm/io/file_text.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

namespace pcm {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

std::string_view next_word(std::string_view& line)
{
    const std::size_t start = std::min(line.find_first_not_of(blanks), line.size());
    const std::size_t end = std::min(line.find_first_of(blanks, start), line.size());
    const std::string_view word = line.substr(start, end - start);
    line.remove_prefix(end);
    return word;
}

std::vector<std::string_view> words_of(std::string_view line)
{
    std::vector<std::string_view> words;
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) words.push_back(word);
    return words;
}

std::string_view trimmed(std::string_view text)
{
    const std::size_t start = std::min(text.find_first_not_of(blanks), text.size());
    return text.substr(start, text.find_last_not_of(blanks) + 1 - start);
}

std::optional<ScalarType> scalar_type(std::string_view kind, std::uint64_t size)
{
    static constexpr struct {
        char kind;
        std::uint64_t size;
        ScalarType type;
    } types[] = {{'I', 1, ScalarType::i8},  {'U', 1, ScalarType::u8},  {'I', 2, ScalarType::i16},
                 {'U', 2, ScalarType::u16}, {'I', 4, ScalarType::i32}, {'U', 4, ScalarType::u32},
                 {'I', 8, ScalarType::i64}, {'U', 8, ScalarType::u64}, {'F', 4, ScalarType::f32},
                 {'F', 8, ScalarType::f64}};
    for (const auto& known : types)
        if (kind.size() == 1 && kind[0] == known.kind && size == known.size) return known.type;
    return std::nullopt;
}

class HeaderParser {
public:
    HeaderParser(const File& file, std::string_view text) : file_(file), text_(text) {}
    PcdHeader parse();

private:
    [[noreturn]] void fail(const std::string& what) const
    {
        throw Error(ErrorCode::bad_format, file_.path(), "line " + std::to_string(header_.lines) + ": " + what);
    }
    std::string_view next_line();
    std::uint64_t number(std::string_view word, std::string_view keyword) const;
    std::vector<std::uint64_t> numbers(const std::vector<std::string_view>& words, std::string_view keyword) const;
    void take(std::string_view keyword, std::string_view rest);
    void parse_encoding(std::string_view rest);
    void make_fields();
    void count_points();

    const File& file_;
    std::string_view text_;
    PcdHeader header_;
    std::vector<std::string> seen_;  // keywords
    std::vector<std::string_view> names_, kinds_;
    std::vector<std::uint64_t> sizes_, counts_;
    std::optional<std::uint64_t> width_, height_, points_;
    std::size_t unknown_lines_ = 0;
};

std::string_view HeaderParser::next_line()
{
    ++header_.lines;
    const std::string_view rest = text_.substr(static_cast<std::size_t>(header_.bytes));
    const std::size_t length = rest.find('\n');
    if (length == std::string_view::npos) {
        // The last line of a file without points may have no line end.
        if (rest.empty() || text_.size() == longest_pcd_header)
            fail("no 'DATA' in the first " + std::to_string(text_.size()) + " bytes; a PCD header ends with this line");
        header_.bytes += rest.size();
        return rest;
    }
    header_.bytes += length + 1;
    return rest.substr(0, length);
}

std::uint64_t HeaderParser::number(std::string_view word, std::string_view keyword) const
{
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc() || end != word.data() + word.size())
        fail("found " + quote_bytes(word) + " after " + std::string(keyword) + ", expected a whole number");
    return value;
}

std::vector<std::uint64_t> HeaderParser::numbers(const std::vector<std::string_view>& words,
                                                 std::string_view keyword) const
{
    std::vector<std::uint64_t> values;
    for (const std::string_view word : words) values.push_back(number(word, keyword));
    return values;
}

void HeaderParser::parse_encoding(std::string_view rest)
{
    const std::string_view name = next_word(rest);
    if (name == "ascii")
        header_.encoding = PcdHeader::Encoding::ascii;
    else if (name == "binary")
        header_.encoding = PcdHeader::Encoding::binary;
    else if (name == "binary_compressed")
        header_.encoding = PcdHeader::Encoding::compressed;
    else
        throw Error(ErrorCode::unsupported, file_.path(),
                    "line " + std::to_string(header_.lines) + ": found the encoding " + quote_bytes(name) +
                        ", expected ascii, binary or binary_compressed");
}

void HeaderParser::take(std::string_view keyword, std::string_view rest)
{
    const std::vector<std::string_view> words = words_of(rest);
    const auto one = [&] {
        if (words.size() != 1)
            fail("found " + std::to_string(words.size()) + " words after " + std::string(keyword) +
                 ", expected one number");
        return number(words[0], keyword);
    };
    if (keyword == "COLUMNS") keyword = "FIELDS";  // its name in the oldest files
    if (std::find(seen_.begin(), seen_.end(), keyword) != seen_.end())
        fail("the header has two lines " + std::string(keyword));
    if (keyword == "VERSION")
        header_.version = words.empty() ? "" : std::string(words[0]);
    else if (keyword == "FIELDS")
        names_ = words;
    else if (keyword == "SIZE")
        sizes_ = numbers(words, keyword);
    else if (keyword == "TYPE")
        kinds_ = words;
    else if (keyword == "COUNT")
        counts_ = numbers(words, keyword);
    else if (keyword == "WIDTH")
        width_ = one();
    else if (keyword == "HEIGHT")
        height_ = one();
    else if (keyword == "POINTS")
        points_ = one();
    else if (keyword == "VIEWPOINT")
        header_.viewpoint = printable_name(trimmed(rest));
    else if (keyword[0] >= 'A' && keyword[0] <= 'Z')
        ++unknown_lines_;
    else
        fail("found " + quote_bytes(trimmed(std::string(keyword) + std::string(rest))) +
             ", expected VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS or DATA");
    seen_.emplace_back(keyword);
}

void HeaderParser::make_fields()
{
    if (names_.empty()) fail("the header has no FIELDS");
    // Version .5 had only single precision: the default for missing lines.
    const auto check = [&](std::size_t count, const char* keyword) {
        if (count && count != names_.size())
            fail("found " + std::to_string(count) + " words after " + keyword + ", expected one for each of the " +
                 std::to_string(names_.size()) + " FIELDS");
        return count != 0;
    };
    const bool has_sizes = check(sizes_.size(), "SIZE"), has_kinds = check(kinds_.size(), "TYPE"),
               has_counts = check(counts_.size(), "COUNT");
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < names_.size(); ++i) {
        PcdField field;
        field.name = printable_name(names_[i]);
        if (field.name.empty()) field.name = "unnamed";
        const std::uint64_t size = has_sizes ? sizes_[i] : 4;
        const std::string_view kind = has_kinds ? kinds_[i] : "F";
        const auto type = scalar_type(kind, size);
        if (!type)
            fail("the field " + quote_bytes(field.name) + " has TYPE " + quote_bytes(kind) + " and SIZE " +
                 std::to_string(size) + ", expected I or U of 1, 2, 4 or 8 bytes or F of 4 or 8");
        field.type = *type;
        const std::uint64_t count = has_counts ? counts_[i] : 1;
        if (count == 0 && !field.is_padding())
            fail("the field " + quote_bytes(field.name) + " has COUNT 0, expected at least 1");
        if (count > (most_pcd_record_bytes - sum) / size)
            throw Error(ErrorCode::unsupported, file_.path(),
                        "a point has more than " + std::to_string(most_pcd_record_bytes) + " bytes, from field " +
                            quote_bytes(field.name) + " on");
        field.count = static_cast<std::uint32_t>(count);
        sum += field.bytes();
        header_.fields.push_back(std::move(field));
    }
}

void HeaderParser::count_points()
{
    if (!points_ && !width_) fail("the header has neither POINTS nor WIDTH");
    header_.height = height_.value_or(1);
    header_.width = width_.value_or(points_.value_or(0));
    const bool overflows = header_.height && header_.width > UINT64_MAX / header_.height;
    const std::uint64_t product = overflows ? 0 : header_.width * header_.height;
    if (!points_ && overflows) fail("WIDTH times HEIGHT is more than any file holds");
    header_.points = points_.value_or(product);
    if (overflows || product != header_.points) {
        header_.notes.push_back("WIDTH " + std::to_string(header_.width) + " and HEIGHT " +
                                std::to_string(header_.height) + " do not match the " + std::to_string(header_.points) +
                                " POINTS, which are read");
        header_.width = header_.points;
        header_.height = 1;
    }
}

PcdHeader HeaderParser::parse()
{
    for (;;) {
        const std::string_view line = trimmed(next_line());
        if (line.empty()) continue;
        std::string_view rest = line;
        if (line[0] == '#') {
            rest.remove_prefix(1);
            const std::string_view comment = rest;
            if (next_word(rest) == "pcm") header_.comments.emplace_back(comment);
            continue;
        }
        const std::string_view keyword = next_word(rest);
        if (keyword == "DATA") {
            parse_encoding(rest);
            break;
        }
        take(keyword, rest);
    }
    make_fields();
    count_points();
    static constexpr std::string_view versions[] = {"", ".5", ".6", ".7", "0.5", "0.6", "0.7"};
    if (std::find(std::begin(versions), std::end(versions), header_.version) == std::end(versions))
        header_.notes.push_back("version " + quote_bytes(header_.version) + " is read as .7");
    if (unknown_lines_)
        header_.notes.push_back(std::to_string(unknown_lines_) +
                                " lines of the header with unknown keywords are ignored");
    return std::move(header_);
}

}  // namespace

std::uint64_t PcdHeader::record_bytes() const
{
    std::uint64_t sum = 0;
    for (const PcdField& field : fields) sum += field.bytes();
    return sum;
}

std::uint64_t PcdHeader::numbers() const
{
    std::uint64_t sum = 0;
    for (const PcdField& field : fields) sum += field.count;
    return sum;
}

PcdHeader read_pcd_header(const File& file)
{
    // Most headers have some hundred bytes; more is read only when their last line is not among the first bytes.
    std::string text;
    for (std::size_t bytes = 4096; bytes <= longest_pcd_header; bytes *= 16) {
        text.resize(bytes);
        const std::size_t got = file.read_some_at(text.data(), bytes, 0);
        text.resize(got);
        if (got < bytes || text.find("\nDATA ") < bytes - 64) break;
    }
    return HeaderParser(file, text).parse();
}

std::string pcd_attribute_name(std::string_view field)
{
    static constexpr std::string_view names[] = {
        "intensity", "return_number",   "number_of_returns", "scan_direction_flag", "edge_of_flight_line",
        "user_data", "scan_angle_rank", "classification",    "point_source_id",     "gps_time",
        "radius",    "curvature"};
    const auto letters = [](std::string_view text) {
        std::string small;
        for (const char c : text)
            if (c != '_') small += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        return small;
    };
    const std::string found = letters(field);
    for (const std::string_view name : names)
        if (letters(name) == found) return std::string(name);
    return std::string(field);
}

}  // namespace pcm
