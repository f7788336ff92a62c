#include "pcm/io/text/text_sample.h"

#include "pcm/io/file_text.h"
#include "pcm/io/text/parse_number.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace pcm {
namespace {

constexpr std::size_t head_bytes = std::size_t{1} << 16;
constexpr std::size_t most_head_rows = 200;
constexpr std::size_t most_other_lines = 64;  // before the first row, not counting comments
constexpr std::size_t most_columns = 1024;
constexpr std::uint64_t whole_file_bytes = std::uint64_t{1} << 20;
constexpr std::size_t pieces = 64, piece_bytes = std::size_t{1} << 14;

// Whole lines of a piece of the file, followed by one more readable byte.
class Piece {
public:
    Piece(const File& file, std::uint64_t at, std::size_t bytes, std::uint64_t file_size) : bytes_(bytes + 2)
    {
        const std::size_t got = file.read_some_at(bytes_.data(), bytes, at);
        begin_ = bytes_.data();
        end_ = begin_ + got;
        const bool last = at + got >= file_size;
        if (last && got && !text::is_line_end(end_[-1])) *end_++ = '\n';
        *end_ = '\0';
        if (!last)  // a CR may be the first half of a line end
            while (end_ != begin_ && (!text::is_line_end(end_[-1]) || (end_[-1] == '\r' && end_ == begin_ + got)))
                --end_;
    }
    const char* begin() const { return begin_; }
    const char* end() const { return end_; }
    void skip_byte_order_mark()
    {
        if (end_ - begin_ >= 3 && std::string_view(begin_, 3) == "\xEF\xBB\xBF") begin_ += 3;
    }
    void skip_line()
    {
        const char* at = begin_;
        if (at != end_) take_line(at);
        begin_ = const_cast<char*>(at);
    }
    std::size_t offset(const char* at) const { return static_cast<std::size_t>(at - bytes_.data()); }

private:
    std::vector<char> bytes_;
    char* begin_;
    char* end_;
};

// The number of fields of a row; 0 unless there are three numbers, and no words unless they are allowed.
std::size_t fields_of_row(const FieldCounts& counts, bool words_allowed)
{
    return counts.numbers >= 3 && (words_allowed || counts.words == 0) ? counts.fields : 0;
}

// Whether reading the number as a float loses nothing: it is the float as printed.
bool is_single(std::string_view word, double value, char point)
{
    float single = 0;
    if (!text::parse_number(word, single, point)) return false;
    if (static_cast<double>(single) == value || std::isnan(value)) return true;
    char printed[32];
    const char* const end = std::to_chars(printed, printed + sizeof printed, single).ptr;
    double back = 0;
    return text::parse_number({printed, static_cast<std::size_t>(end - printed)}, back) && back == value;
}

void look_at(std::string_view word, char point, ColumnLook& look, double& value)
{
    value = 0;
    if (word.empty() || is_no_data(word)) {
        ++look.empty;
        look.marks += !word.empty();
        look.whole = false;
        return;
    }
    if (!text::parse_number(word, value, point)) {
        ++look.words;
        return;
    }
    ++look.values;
    look.least = std::min(look.least, value);
    look.most = std::max(look.most, value);
    look.digits = std::max(look.digits, text::significant_digits(word));
    if (word.find_first_of(".,eE") != std::string_view::npos) look.digits_only = false;
    if (value != std::floor(value) || !std::isfinite(value)) look.whole = false;
    if (look.whole && std::fabs(value) >= 9007199254740992.0) {
        std::int64_t i = 0;
        std::uint64_t u = 0;
        const bool is_i = text::parse_number(word, i, point), is_u = text::parse_number(word, u, point);
        look.fits_i64 = look.fits_i64 && is_i;
        look.fits_u64 = look.fits_u64 && is_u;
        look.beyond_double = look.beyond_double || (is_u ? static_cast<std::uint64_t>(value) != u
                                                         : is_i && static_cast<std::int64_t>(value) != i);
    }
    if (value < 0) look.fits_u64 = false;
    look.single = look.single && is_single(word, value, point);
}

// Adds one line to the sample.
void look_at_line(std::string_view line, TextSample& sample, std::vector<std::string_view>& words,
                  std::vector<double>& values)
{
    if (is_blank_or_comment(line, sample.dialect.separator)) return;
    split_fields(line, sample.dialect, words);
    const FieldCounts counts = count_fields(words, sample.dialect.point);
    const bool with_words = counts.fields == sample.columns || counts.like_a_row(sample.columns);
    if (fields_of_row(counts, with_words) < sample.columns) {
        ++sample.odd_lines;
        return;
    }
    if (counts.fields > sample.columns) ++sample.longer_rows;
    ++sample.rows;
    sample.row_bytes += static_cast<double>(line.size() + 1);
    values.resize(sample.columns);
    for (std::size_t c = 0; c < sample.columns; ++c)
        look_at(words[c], sample.dialect.point, sample.looks[c], values[c]);
    for (std::size_t c = 0; c + 2 < sample.columns; ++c) {
        const double length =
            std::sqrt(values[c] * values[c] + values[c + 1] * values[c + 1] + values[c + 2] * values[c + 2]);
        if (length == 0) ++sample.looks[c].null_vectors;
        // Normals are printed with at least three decimals.
        if (std::fabs(length - 1) < 2e-3) ++sample.looks[c].unit_vectors;
    }
}

void look_at_pieces(const File& file, TextSample& sample)
{
    const std::uint64_t size = file.size();
    const std::uint64_t bytes = size - std::min(size, sample.first_row_byte);
    sample.looks.assign(sample.columns, {});
    sample.row_bytes = 0;
    std::vector<std::string_view> words;
    std::vector<double> values;
    const auto look = [&](std::uint64_t at, std::size_t length, bool in_a_line) {
        Piece piece(file, at, length, size);
        if (in_a_line) piece.skip_line();
        for (const char* p = piece.begin(); p != piece.end();) look_at_line(take_line(p), sample, words, values);
    };
    if (bytes <= whole_file_bytes) {
        look(sample.first_row_byte, static_cast<std::size_t>(bytes), false);
    } else {
        for (std::size_t i = 0; i < pieces; ++i)
            look(sample.first_row_byte + (bytes - piece_bytes) / (pieces - 1) * i, piece_bytes, i > 0);
    }
    if (sample.rows) sample.row_bytes /= static_cast<double>(sample.rows);
    sample.row_bytes = std::max(sample.row_bytes, 1.0);
}

void refuse_binary(const File& file, const Piece& piece)
{
    const std::string_view bytes(piece.begin(), static_cast<std::size_t>(piece.end() - piece.begin()));
    const std::string hint = "a text file of points was expected";
    if (bytes.substr(0, 2) == "\xFF\xFE" || bytes.substr(0, 2) == "\xFE\xFF")
        throw Error(ErrorCode::unsupported, file.path(), "this is text in UTF-16",
                    "save it as UTF-8 or plain ASCII to read it");
    for (const char& c : bytes) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte < 0x20 && !text::is_blank(c) && !text::is_line_end(c) && byte != '\v' && byte != '\f' &&
             byte != 0x1A) ||
            byte == 0x7F) {
            const std::size_t offset = piece.offset(&c);
            throw Error(ErrorCode::bad_format, file.path(),
                        "byte " + std::to_string(offset) + " is " + quote_bytes({&c, 1}) +
                            ", which is not text; the file begins with " + quote_bytes(bytes),
                        hint);
        }
    }
}

struct HeadLine {
    std::string_view text;
    std::size_t offset;
};

// How well a dialect splits lines.
struct Score {
    std::size_t rows = 0;  // number of rows with the most frequent number of numbers
    std::size_t columns = 0;
    std::size_t first = 0;  // line
};

Score score_of(const std::vector<HeadLine>& lines, std::size_t from, const TextDialect& dialect, bool words_allowed)
{
    std::vector<std::string_view> words;
    std::vector<std::size_t> counts;  // number of fields in each row
    Score score;
    score.first = lines.size();
    std::size_t others = 0;
    for (std::size_t i = from; i < lines.size() && counts.size() < most_head_rows; ++i) {
        if (is_blank_or_comment(lines[i].text, dialect.separator)) continue;
        split_fields(lines[i].text, dialect, words);
        const FieldCounts found = count_fields(words, dialect.point);
        const std::size_t fields = fields_of_row(found, words_allowed);
        if (fields == 0) {
            if (counts.empty() && !found.like_a_row(found.fields) && ++others > most_other_lines) return {};
            if (!counts.empty()) counts.push_back(0);
            continue;
        }
        if (counts.empty()) score.first = i;
        counts.push_back(fields);
    }
    std::vector<std::size_t> sorted = counts;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 0; i < sorted.size();) {
        std::size_t k = i;
        while (k < sorted.size() && sorted[k] == sorted[i]) ++k;
        if (sorted[i] >= 3 && k - i > score.rows) {
            score.rows = k - i;
            score.columns = sorted[i];
        }
        i = k;
    }
    return score;
}

// The dialect in which most lines are rows. If two split all lines, the first one is taken.
Score best_score(const std::vector<HeadLine>& lines, std::size_t from, const TextHints& hints, bool words_allowed,
                 TextDialect& dialect_of_best)
{
    static constexpr TextDialect dialects[] = {{' ', '.'}, {',', '.'},  {';', '.'}, {'\t', '.'},
                                               {';', ','}, {'\t', ','}, {' ', ','}};
    Score best;
    for (const TextDialect& dialect : dialects) {
        if (hints.separator && dialect.separator != *hints.separator) continue;
        const Score score = score_of(lines, from, dialect, words_allowed);
        if (score.rows <= best.rows || score.columns > most_columns) continue;
        best = score;
        dialect_of_best = dialect;
    }
    return best;
}

// The first line that is a row, or seems to be one that has a fault: it must not be taken for a title.
std::size_t first_row(const std::vector<HeadLine>& lines, std::size_t from, const Score& score,
                      const TextDialect& dialect)
{
    std::vector<std::string_view> words;
    for (std::size_t i = from; i < score.first; ++i) {
        if (is_blank_or_comment(lines[i].text, dialect.separator)) continue;
        split_fields(lines[i].text, dialect, words);
        if (count_fields(words, dialect.point).like_a_row(score.columns)) return i;
    }
    return score.first;
}

}  // namespace

std::uint64_t TextSample::estimated_rows(std::uint64_t file_size) const
{
    const auto bytes = static_cast<double>(file_size - std::min(file_size, first_row_byte));
    return static_cast<std::uint64_t>(std::ceil(bytes / row_bytes));
}

std::optional<TextSample> sample_text(const File& file, const TextHints& hints)
{
    const std::uint64_t size = file.size();
    Piece head(file, 0, static_cast<std::size_t>(std::min<std::uint64_t>(size, head_bytes)), size);
    refuse_binary(file, head);
    head.skip_byte_order_mark();
    std::vector<HeadLine> lines;
    for (const char* at = head.begin(); at != head.end();) {
        const std::size_t offset = head.offset(at);
        lines.push_back({take_line(at), offset});
    }

    const std::size_t from = std::min(lines.size(), hints.skip_lines.value_or(0));
    TextSample sample;
    Score best = best_score(lines, from, hints, false, sample.dialect);
    // Where most lines hold words next to the numbers, there are columns of text.
    TextDialect other;
    const Score with_words = best_score(lines, from, hints, true, other);
    if (with_words.rows > 2 * best.rows) {
        best = with_words;
        sample.dialect = other;
    }
    if (best.rows == 0) return std::nullopt;
    sample.columns = best.columns;
    sample.first_row = first_row(lines, from, best, sample.dialect);
    sample.first_row_byte = lines[sample.first_row].offset;
    for (std::size_t i = 0; i < sample.first_row; ++i) sample.head.emplace_back(lines[i].text);
    look_at_pieces(file, sample);
    const ColumnLook& last = sample.looks.back();
    if (sample.columns > 3 && !last.values && !last.marks && !last.words) {  // lines end with a separator
        --sample.columns;
        sample.looks.pop_back();
        sample.longer_rows = 0;
    }
    return sample;
}

TextSample sample_rows(const File& file, const TextDialect& dialect, std::size_t columns, std::uint64_t first_row_byte)
{
    TextSample sample;
    sample.dialect = dialect;
    sample.columns = columns;
    sample.first_row_byte = first_row_byte;
    look_at_pieces(file, sample);
    return sample;
}

}  // namespace pcm
