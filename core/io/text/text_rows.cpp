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

std::string fields_text(std::size_t count) { return std::to_string(count) + (count == 1 ? " field" : " fields"); }

}  // namespace

void TextCounts::add(const TextCounts& later)
{
    if (!longer_lines) first_longer_line = later.first_longer_line;
    if (!missing_values) first_missing = later.first_missing;
    if (!bad_lines) first_bad_line = later.first_bad_line;
    rows += later.rows;
    longer_lines += later.longer_lines;
    empty_fields += later.empty_fields;
    missing_values += later.missing_values;
    rounded_values += later.rounded_values;
    bad_lines += later.bad_lines;
    words.insert(words.end(), later.words.begin(), later.words.end());
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
    if (missing_values)
        notes.push_back(grouped(missing_values) + (missing_values == 1 ? " missing value is" : " missing values are") +
                        " NaN, the first is " + first_missing);
    if (rounded_values)
        notes.push_back(
            grouped(rounded_values) + (rounded_values == 1 ? " value has" : " values have") +
            " more digits than a 32-bit float keeps and were rounded; name the column NAME:f64 to keep them");
    for (const Words& text : words)
        if (text.count)
            notes.push_back("column " + std::to_string(text.column) +
                            (text.name.empty() ? "" : " (" + text.name + ")") +
                            " holds text, which is not read: " + grouped(text.count) +
                            (text.count == 1 ? " field" : " fields") + ", the first is " + text.first);
    if (bad_lines)
        notes.push_back(grouped(bad_lines) + (bad_lines == 1 ? " bad line was" : " bad lines were") +
                        " skipped, the first is " + first_bad_line);
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
        if (field.role != TextField::Role::text) continue;
        slots_[i].words = counts_.words.size();
        counts_.words.push_back({i + 1, field.name, {}, 0});
    }
    pending_.resize(counts_.words.size());
    static_assert(static_cast<int>(Slot::Kind::i8) == static_cast<int>(ScalarType::i8) &&
                  static_cast<int>(Slot::Kind::f64) == static_cast<int>(ScalarType::f64));
}

void TextRows::count_word(std::size_t column, std::string_view word)
{
    if (word.empty()) return;
    TextCounts::Words& words = counts_.words[column];
    if (words.count++ == 0) words.first = quote_bytes(word);
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
                if (slot.words != Slot::none) pending_[slot.words] = {start, static_cast<std::size_t>(at - start)};
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
    for (std::size_t i = 0; i < pending_.size(); ++i) count_word(i, pending_[i]);
    return at + (at[0] == '\r' && at[1] == '\n' ? 2 : 1);
}

std::optional<TextRows::Fault> TextRows::careful_field(std::string_view word, std::size_t i, std::size_t row,
                                                       std::uint64_t line_number)
{
    const TextField& field = form_.fields[i];
    const Slot& slot = slots_[i];
    if (slot.kind == Slot::Kind::skipped) return std::nullopt;
    const ScalarType type = field.role == TextField::Role::axis ? ScalarType::f64 : field.type;
    const std::string column = "column " + std::to_string(i + 1) + " (" + field.name + ")";
    const auto fault = [&](const std::string& expected) {
        double number = 0;
        return Fault{"found " + quote_bytes(word) + " in " + column + ", expected " + expected,
                     !text::parse_number(word, number, form_.dialect.point)};
    };
    return with_type(type, [&](auto value) -> std::optional<Fault> {
        using T = decltype(value);
        const bool missing = is_no_data(word);
        if (std::is_floating_point_v<T> && (missing || word.empty()) && field.role == TextField::Role::attribute) {
            if constexpr (std::is_floating_point_v<T>) value = std::numeric_limits<T>::quiet_NaN();
            if (!missing)
                ++counts_.empty_fields;
            else if (counts_.missing_values++ == 0)
                counts_.first_missing = quote_bytes(word) + " in line " + std::to_string(line_number) + ", " + column;
        } else if (!text::parse_number(word, value, form_.dialect.point)) {
            return fault(std::is_floating_point_v<T>
                             ? std::string("a number")
                             : "a whole number from " + std::to_string(std::numeric_limits<T>::min()) + " to " +
                                   std::to_string(std::numeric_limits<T>::max()));
        }
        if constexpr (std::is_same_v<T, float>) {
            double wide = 0;
            if (std::isinf(value) && text::parse_number(word, wide, form_.dialect.point) && !std::isinf(wide))
                return fault("a number that a 32-bit float can hold");
            if (text::significant_digits(word) > most_float_digits) ++counts_.rounded_values;
        }
        std::memcpy(slot.to + row * slot.step, &value, sizeof value);
        return std::nullopt;
    });
}

std::optional<TextRows::Fault> TextRows::careful_row(std::string_view line, std::size_t row, std::uint64_t line_number)
{
    const std::size_t expected = form_.fields.size();
    const bool longer = words_.size() > expected;
    if (words_.size() < expected || (longer && !form_.longer_lines)) {
        std::string names;
        for (const TextField& field : form_.fields) names += (names.empty() ? "" : " ") + field.name;
        return Fault{"found " + fields_text(words_.size()) + ", expected " + std::to_string(expected) + " (" + names +
                     "); the line is " + quote_bytes(line)};
    }
    const std::uint64_t empty = counts_.empty_fields, missing = counts_.missing_values,
                        rounded = counts_.rounded_values;
    for (std::size_t i = 0; i < expected; ++i)
        if (auto fault = careful_field(words_[i], i, row, line_number)) {
            counts_.empty_fields = empty;  // those of a line that is not read do not count
            counts_.missing_values = missing;
            counts_.rounded_values = rounded;
            fault->what += "; the line is " + quote_bytes(line);
            return fault;
        }
    for (std::size_t i = 0; i < expected; ++i)
        if (slots_[i].words != Slot::none) count_word(slots_[i].words, words_[i]);
    if (longer && counts_.longer_lines++ == 0) counts_.first_longer_line = line_number;
    return std::nullopt;
}

TextRows::Line TextRows::careful_line(std::string_view line, std::size_t row, std::uint64_t line_number)
{
    split_fields(line, form_.dialect, words_);
    const std::size_t expected = form_.fields.size();
    if (words_.size() == expected + 1 && words_.back().empty()) words_.pop_back();  // the line ends with a separator
    const bool odd = words_.size() < expected || (words_.size() > expected && !form_.longer_lines);
    if (odd && odd_line_ && odd_line_(line_number, words_)) return Line::handled;
    const std::optional<Fault> fault = careful_row(line, row, line_number);
    if (!fault) return Line::row;
    const std::string what = "line " + std::to_string(line_number) + ": " + fault->what;
    if (!form_.skip_bad_lines || !fault->bad_line) throw Error(ErrorCode::bad_format, path_, what, form_.hint);
    if (counts_.bad_lines++ == 0) counts_.first_bad_line = what;
    return Line::skipped;
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
        const Line found = is_blank_or_comment(line, form_.dialect.separator)
                               ? Line::handled
                               : careful_line(line, row, source.lines_read() + 1);
        source.advance(at, 1);
        row += found == Line::row;
        // A skipped line takes the place of a row.
        most -= found == Line::skipped;
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
