#include "pcm/io/text/text_rows.h"

#include "pcm/cloud/with_type.h"
#include "pcm/io/file_text.h"
#include "pcm/io/text/parse_number.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace pcm {
namespace {

// A 32-bit float never needs more digits to be distinct from its neighbours.
constexpr std::size_t most_float_digits = 9;

bool is_padding(char c, char separator) { return text::is_blank(c) && c != separator; }

std::string_view trimmed(std::string_view word, char separator)
{
    while (!word.empty() && is_padding(word.front(), separator)) word.remove_prefix(1);
    while (!word.empty() && is_padding(word.back(), separator)) word.remove_suffix(1);
    return word;
}

// The end of a quoted field that begins at `at`: its closing quote. Two quotes inside mean one.
std::size_t closing_quote(std::string_view line, std::size_t at)
{
    const char quote = line[at];
    for (std::size_t i = at + 1; i < line.size(); ++i) {
        if (line[i] != quote) continue;
        if (i + 1 < line.size() && line[i + 1] == quote)
            ++i;
        else
            return i;
    }
    return std::string_view::npos;
}

std::string fields_text(std::size_t count) { return std::to_string(count) + (count == 1 ? " field" : " fields"); }

}  // namespace

void split_fields(std::string_view line, const TextDialect& dialect, std::vector<std::string_view>& fields)
{
    fields.clear();
    const char separator = dialect.separator;
    const bool blanks = separator == ' ';
    bool behind_separator = false;
    for (std::size_t at = 0;;) {
        while (at < line.size() && (blanks ? text::is_blank(line[at]) : is_padding(line[at], separator))) ++at;
        if (at == line.size()) {
            if (behind_separator) fields.emplace_back();
            return;
        }
        std::size_t stop = at;
        const std::size_t close =
            line[at] == '"' || line[at] == '\'' ? closing_quote(line, at) : std::string_view::npos;
        if (close != std::string_view::npos) {
            stop = close + 1;
            if (!blanks)
                while (stop < line.size() && is_padding(line[stop], separator)) ++stop;
        }
        const auto ends = [&] {
            return stop == line.size() || (blanks ? text::is_blank(line[stop]) : line[stop] == separator);
        };
        if (close != std::string_view::npos && ends()) {
            fields.push_back(line.substr(at + 1, close - at - 1));
        } else {
            for (stop = at; !ends();) ++stop;
            fields.push_back(trimmed(line.substr(at, stop - at), separator));
        }
        behind_separator = !blanks && stop < line.size();
        at = stop + behind_separator;
    }
}

bool is_blank_or_comment(std::string_view line)
{
    while (!line.empty() && (text::is_blank(line.front()) || line.front() == '\v' || line.front() == '\f'))
        line.remove_prefix(1);
    return line.empty() || line.front() == '#' || line.front() == '%' || line.substr(0, 2) == "//";
}

std::vector<std::string> TextCounts::notes() const
{
    std::vector<std::string> notes;
    if (longer_lines)
        notes.push_back(grouped(longer_lines) + (longer_lines == 1 ? " line has" : " lines have") +
                        " more fields than there are columns, the first is line " + std::to_string(first_longer_line) +
                        ": the further fields are not read");
    if (empty_fields)
        notes.push_back(grouped(empty_fields) + (empty_fields == 1 ? " empty field is" : " empty fields are") + " NaN");
    if (rounded_values)
        notes.push_back(
            grouped(rounded_values) + (rounded_values == 1 ? " value has" : " values have") +
            " more digits than a 32-bit float keeps and were rounded; name the column NAME:f64 to keep them");
    return notes;
}

TextRows::TextRows(std::filesystem::path path, TextForm form, OddLine odd_line)
    : path_(std::move(path)), form_(std::move(form)), odd_line_(std::move(odd_line))
{
    slots_.resize(form_.fields.size());
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        const TextField& field = form_.fields[i];
        if (field.role == TextField::Role::axis) slots_[i].kind = Slot::Kind::f64;
        if (field.role == TextField::Role::attribute)
            slots_[i].kind = static_cast<Slot::Kind>(field.type);  // both enumerations start with i8 = 1
    }
    static_assert(static_cast<int>(Slot::Kind::i8) == static_cast<int>(ScalarType::i8) &&
                  static_cast<int>(Slot::Kind::f64) == static_cast<int>(ScalarType::f64));
}

void TextRows::fail(std::uint64_t line_number, const std::string& what) const
{
    throw Error(ErrorCode::bad_format, path_, "line " + std::to_string(line_number) + ": " + what, form_.hint);
}

void TextRows::bind(PointBatch& batch, std::size_t first)
{
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        const TextField& field = form_.fields[i];
        Slot& slot = slots_[i];
        if (field.role == TextField::Role::axis) {
            slot.step = sizeof(double);
            slot.to = reinterpret_cast<std::byte*>(batch.xyz[field.index].data() + first);
        } else if (field.role == TextField::Role::attribute) {
            Column& column = batch.attributes[field.index];
            slot.step = column.point_bytes();
            slot.to = column.data() + first * slot.step + field.component * size_of(field.type);
        }
    }
}

// Reads a row of plain numbers and plain separators; returns the beginning of the next line, null for anything else.
// One long function: it takes most of the time of reading text, and inlines its parts.
template <bool Blanks>
const char* TextRows::plain_row(const char* at, const char* end, std::size_t row)
{
    const char separator = form_.dialect.separator, point = form_.dialect.point;
    const auto skip_padding = [&] {
        if constexpr (Blanks) {
            while (text::is_blank(*at)) ++at;
        } else {
            while (is_padding(*at, separator)) ++at;
        }
    };
    const auto integer = [&](const Slot& slot, auto value) {
        if (!text::take_integer(at, point, value)) return false;
        std::memcpy(slot.to + row * slot.step, &value, sizeof value);
        return true;
    };
    std::uint64_t rounded = 0;
    bool first = true;
    for (const Slot& slot : slots_) {
        if constexpr (!Blanks) {
            if (!first && *at++ != separator) return nullptr;
            first = false;
        }
        skip_padding();
        switch (slot.kind) {
            case Slot::Kind::f64: {
                double value;
                if (!text::take_real(at, end, value, point)) return nullptr;
                std::memcpy(slot.to + row * slot.step, &value, sizeof value);
                break;
            }
            case Slot::Kind::f32: {
                float value;
                const char* const start = at;
                if (!text::take_real(at, end, value, point)) return nullptr;
                if (!(std::fabs(value) <= std::numeric_limits<float>::max())) return nullptr;
                if (static_cast<std::size_t>(at - start) > most_float_digits + 3 &&
                    text::significant_digits({start, static_cast<std::size_t>(at - start)}) > most_float_digits)
                    ++rounded;
                std::memcpy(slot.to + row * slot.step, &value, sizeof value);
                break;
            }
            case Slot::Kind::u8:
                if (!integer(slot, std::uint8_t{})) return nullptr;
                break;
            case Slot::Kind::u16:
                if (!integer(slot, std::uint16_t{})) return nullptr;
                break;
            case Slot::Kind::i8:
                if (!integer(slot, std::int8_t{})) return nullptr;
                break;
            case Slot::Kind::i16:
                if (!integer(slot, std::int16_t{})) return nullptr;
                break;
            case Slot::Kind::i32:
                if (!integer(slot, std::int32_t{})) return nullptr;
                break;
            case Slot::Kind::u32:
                if (!integer(slot, std::uint32_t{})) return nullptr;
                break;
            case Slot::Kind::i64:
                if (!integer(slot, std::int64_t{})) return nullptr;
                break;
            case Slot::Kind::u64:
                if (!integer(slot, std::uint64_t{})) return nullptr;
                break;
            case Slot::Kind::skipped: {
                const char* const start = at;
                while (!text::is_blank(*at) && !text::is_line_end(*at) && *at != separator && *at != '"' && *at != '\'')
                    ++at;
                if (*at == '"' || *at == '\'' || (Blanks && at == start)) return nullptr;
                if constexpr (!Blanks) {  // fields with blanks inside
                    while (!text::is_line_end(*at) && *at != separator && *at != '"' && *at != '\'') ++at;
                    if (*at == '"' || *at == '\'') return nullptr;
                }
                break;
            }
        }
        if constexpr (Blanks) {
            if (!text::is_blank(*at) && !text::is_line_end(*at)) return nullptr;
        } else {
            skip_padding();
        }
    }
    skip_padding();
    if (!text::is_line_end(*at)) return nullptr;
    counts_.rounded_values += rounded;
    return at + (at[0] == '\r' && at[1] == '\n' ? 2 : 1);
}

void TextRows::careful_field(std::string_view word, std::size_t i, std::size_t row, std::string_view line,
                             std::uint64_t line_number)
{
    const TextField& field = form_.fields[i];
    const Slot& slot = slots_[i];
    if (slot.kind == Slot::Kind::skipped) return;
    const ScalarType type = field.role == TextField::Role::axis ? ScalarType::f64 : field.type;
    const auto complain = [&](const std::string& expected) {
        fail(line_number, "found " + quote_bytes(word) + " in column " + std::to_string(i + 1) + " (" + field.name +
                              "), expected " + expected + "; the line is " + quote_bytes(line));
    };
    with_type(type, [&](auto value) {
        using T = decltype(value);
        if (std::is_floating_point_v<T> && word.empty() && field.role == TextField::Role::attribute) {
            if constexpr (std::is_floating_point_v<T>) value = std::numeric_limits<T>::quiet_NaN();
            ++counts_.empty_fields;
        } else if (!text::parse_number(word, value, form_.dialect.point)) {
            complain(std::is_floating_point_v<T>
                         ? std::string("a number")
                         : "a whole number from " + std::to_string(std::numeric_limits<T>::min()) + " to " +
                               std::to_string(std::numeric_limits<T>::max()));
        }
        if constexpr (std::is_same_v<T, float>) {
            double wide = 0;
            if (std::isinf(value) && text::parse_number(word, wide, form_.dialect.point) && !std::isinf(wide))
                complain("a number that a 32-bit float can hold");
            if (text::significant_digits(word) > most_float_digits) ++counts_.rounded_values;
        }
        std::memcpy(slot.to + row * slot.step, &value, sizeof value);
    });
}

// False when the line was not a row and odd_line_ has handled it.
bool TextRows::careful_row(std::string_view line, std::size_t row, std::uint64_t line_number)
{
    split_fields(line, form_.dialect, words_);
    const std::size_t expected = form_.fields.size();
    if (words_.size() == expected + 1 && words_.back().empty()) words_.pop_back();  // the line ends with a separator
    const bool longer = words_.size() > expected;
    if (words_.size() < expected || (longer && !form_.longer_lines)) {
        if (odd_line_ && odd_line_(line_number, words_)) return false;
        std::string names;
        for (const TextField& field : form_.fields) names += (names.empty() ? "" : " ") + field.name;
        fail(line_number, "found " + fields_text(words_.size()) + ", expected " + std::to_string(expected) + " (" +
                              names + "); the line is " + quote_bytes(line));
    }
    for (std::size_t i = 0; i < expected; ++i) careful_field(words_[i], i, row, line, line_number);
    if (longer && counts_.longer_lines++ == 0) counts_.first_longer_line = line_number;
    return true;
}

std::size_t TextRows::read(TextSource& source, PointBatch& batch, std::size_t first, std::size_t most)
{
    bind(batch, first);
    std::size_t row = 0;
    const std::uint64_t rows_before = counts_.rows;
    const bool blanks = form_.dialect.separator == ' ';
    while (row < most && source.fill()) {
        const char* at = source.at();
        const char* const end = source.end();
        const std::size_t before = row;
        while (row < most && at != end) {
            const char* const next = blanks ? plain_row<true>(at, end, row) : plain_row<false>(at, end, row);
            if (!next) break;
            at = next;
            ++row;
        }
        source.advance(at, row - before);
        if (row == most || at == end) continue;
        const std::string_view line = take_line(at);
        counts_.rows = rows_before + row;
        if (!is_blank_or_comment(line) && careful_row(line, row, source.lines_read() + 1)) ++row;
        source.advance(at, 1);
    }
    counts_.rows = rows_before + row;
    return row;
}

std::size_t TextRows::most_rows(std::uint64_t bytes, std::size_t max_points) const
{
    const std::uint64_t held = bytes / (2 * slots_.size()) + 1;  // a digit and a separator each
    return static_cast<std::size_t>(std::min<std::uint64_t>(held, std::max<std::size_t>(max_points, 1)));
}

}  // namespace pcm
