#include "pcm/io/text/text_reader.h"

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/file_text.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/text/parse_number.h"
#include "pcm/io/text/text_columns.h"
#include "pcm/io/text/text_header.h"
#include "pcm/io/text/text_names.h"
#include "pcm/io/text/text_rows.h"
#include "pcm/io/text/text_sample.h"
#include "pcm/io/text/text_source.h"
#include "pcm/system/file.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <utility>

namespace pcm {
namespace {

constexpr const char* override_hint =
    "if these are not the columns, name them (--columns), for example \"x y z intensity r g b\" or with types \"x y z "
    "id:u64 intensity:f64\"; a column - is skipped. Lines that are not points can be left out (--skip-bad-lines)";
constexpr const char* naming_hint =
    "name the columns from the left (--columns), for example \"x y z intensity\", or \"- y x z -\" for number, "
    "northing, "
    "easting, height and code; a column - is skipped. Titles can be skipped (--skip-lines)";

std::optional<std::uint64_t> count_in(std::string_view line)
{
    std::vector<std::string_view> words;
    split_fields(line, {}, words);
    std::uint64_t count = 0;
    const auto digits = [](std::string_view word) { return std::all_of(word.begin(), word.end(), text::is_digit); };
    if (words.size() != 1 || !digits(words[0]) || !text::parse_number(words[0], count)) return std::nullopt;
    return count;
}

std::string separator_text(const TextDialect& dialect)
{
    return name_of_separator(dialect.separator) + (dialect.point == ',' ? ", with decimal commas" : "");
}

TextLayout layout_of(const std::vector<TextColumn>& columns, const TextPlan& plan, const TextSample& sample)
{
    TextLayout layout;
    layout.separator = sample.dialect.separator;
    layout.skip_lines = sample.first_row;
    for (const TextColumn& column : columns)
        layout.columns.push_back(printable_name(column.name) +
                                 (column.type ? ":" + std::string(name_of(*column.type)) : ""));
    layout.colour_range = plan.colour_range;
    return layout;
}

class TextReader final : public PointReader {
public:
    TextReader(const std::filesystem::path& path, const ReadOptions& options, const TextConventions& conventions)
        : file_(path, File::Mode::read), file_size_(file_.size()), conventions_(conventions)
    {
        const TextLayout& layout = options.text;
        skip_bad_lines_ = options.skip_bad_lines;
        check_layout(layout);
        const auto sample = sample_text(file_, {layout.separator, layout.skip_lines});
        if (sample)
            plan(layout, *sample);
        else
            plan_without_rows(layout);
    }

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    double fraction_read() const override
    {
        return finished_ || !file_size_ ? 1.0
                                        : static_cast<double>(source_->bytes_read()) / static_cast<double>(file_size_);
    }

private:
    [[noreturn]] void fail(ErrorCode code, const std::string& what, const std::string& hint = override_hint) const
    {
        throw Error(code, file_.path(), what, hint);
    }
    void plan(const TextLayout& layout, const TextSample& sample);
    void plan_without_rows(const TextLayout& layout);
    void start(TextPlan plan, const TextDialect& dialect, std::uint64_t byte, std::uint64_t line);
    void find_count(const std::vector<std::string>& head, std::size_t skipped);
    std::vector<TextColumn> columns_of(const TextLayout& layout, const TextSample& sample);
    std::vector<TextColumn> named_by(const TextLayout& layout, const TextSample& sample) const;
    std::optional<TextHeader> find_header(const TextSample& sample);
    void refuse_half_headers(const TextSample& sample, std::size_t skipped) const;
    std::vector<std::string> set_text_apart(std::vector<TextColumn>& columns, const TextSample& sample) const;
    void note_titles(const TextSample& sample, std::size_t skipped);
    void refuse_grids(const std::vector<std::string>& head) const;
    bool begins_list(std::uint64_t line, const std::vector<std::string_view>& fields);
    void end_list(const std::string& where);
    void finish();

    File file_;
    std::uint64_t file_size_;
    TextConventions conventions_;
    FileInfo info_;
    std::optional<TextSource> source_;
    std::optional<TextRows> rows_;
    std::size_t batch_points_ = 1;
    bool skip_bad_lines_ = false;
    std::size_t header_line_ = 0;  // counted from 1; 0 without
    std::optional<TextHeader> header_;
    std::vector<std::string> label_names_;  // names in columns of text, by their place; empty for others
    // The current list of points, as its first line states it.
    std::optional<std::uint64_t> promised_;
    std::uint64_t promise_line_ = 0;
    std::uint64_t lines_before_list_ = 0;
    bool finished_ = false;
};

void TextReader::refuse_grids(const std::vector<std::string>& head) const
{
    for (const std::string& line : head) {
        std::string start = line.substr(0, 5);
        for (char& c : start) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        if (start == "ncols")
            fail(ErrorCode::unsupported, "this is a grid of heights (ESRI ASCII raster), not a list of points",
                 "convert it to points, one line x y z per point");
    }
}

std::optional<TextHeader> TextReader::find_header(const TextSample& sample)
{
    for (std::size_t i = sample.head.size(); i-- > 0;) {
        auto header = read_header(sample.head[i], sample.dialect);
        if (!header) continue;
        const std::size_t names = header->columns.size();
        header_line_ = i + 1;
        if (names == sample.columns) return header;
        if (is_blank_or_comment(sample.head[i], sample.dialect.separator)) continue;  // a sentence
        fail(ErrorCode::bad_format, "line " + std::to_string(header_line_) + " names " + std::to_string(names) +
                                        " columns, most lines from line " + std::to_string(sample.first_row + 1) +
                                        " on have " + std::to_string(sample.columns));
    }
    header_line_ = 0;
    return std::nullopt;
}

// Names that are not understood do not justify taking the columns in their order: that would mirror many clouds.
void TextReader::refuse_half_headers(const TextSample& sample, std::size_t skipped) const
{
    for (std::size_t i = 0; i < sample.head.size(); ++i) {
        const std::string& line = sample.head[i];
        const bool comment = is_blank_or_comment(line, sample.dialect.separator);
        if (!comment && axes_named(line, sample.dialect) == 2)
            fail(ErrorCode::bad_format,
                 "line " + std::to_string(i + 1) + " is " + quote_bytes(line) +
                     ", expected the names of the columns with x, y and z once each",
                 naming_hint);
        if (comment || i < skipped || count_in(line)) continue;
        std::string text;
        for (const std::string& name : unknown_names(line, sample.dialect, sample.columns))
            text += (text.empty() ? "" : ", ") + name;
        if (!text.empty())
            fail(ErrorCode::bad_format,
                 "line " + std::to_string(i + 1) + " seems to name the columns: " + text +
                     "; which of them are x, y and z is not understood",
                 naming_hint);
    }
}

std::vector<TextColumn> TextReader::named_by(const TextLayout& layout, const TextSample& sample) const
{
    std::vector<TextColumn> columns;
    for (const std::string& column : layout.columns) {
        const NamedColumn named = named_column(column);
        columns.push_back({named.name, named.type, false});
    }
    if (columns.size() != sample.columns)
        fail(ErrorCode::bad_format, std::to_string(columns.size()) + " columns were named, most lines from line " +
                                        std::to_string(sample.first_row + 1) + " on have " +
                                        std::to_string(sample.columns));
    return columns;
}

std::vector<TextColumn> TextReader::columns_of(const TextLayout& layout, const TextSample& sample)
{
    if (!layout.columns.empty()) return named_by(layout, sample);
    if ((header_ = find_header(sample))) return header_->columns;
    refuse_half_headers(sample, layout.skip_lines.value_or(0));
    const std::string first = "line " + std::to_string(sample.first_row + 1);
    for (std::size_t c = 0; c < sample.columns; ++c)
        if (sample.looks[c].words > sample.looks[c].values)
            fail(ErrorCode::bad_format,
                 "column " + std::to_string(c + 1) + " of the lines from " + first +
                     " on holds words, and no line names the columns",
                 naming_hint);
    std::vector<TextColumn> columns;
    std::string usual;
    for (const std::string& text : conventions_.columns) {
        const std::vector<std::string> names = parse_columns(text);
        usual += (usual.empty() ? "" : " or ") + text;
        if (names.size() != sample.columns) continue;
        for (const std::string& name : names) columns.push_back({name, std::nullopt, false});
        return columns;
    }
    if (!conventions_.others_refused.empty())
        fail(ErrorCode::unsupported,
             first + " has " + std::to_string(sample.columns) + " numbers, expected " + usual + " in a ." +
                 extension_of(file_.path()) + " file",
             std::string(conventions_.others_refused));
    return guess_columns(sample.looks, sample.rows);
}

// Columns that hold words are not read: descriptions, and numbers of points with letters. Others in which words are
// rare are columns of numbers with bad values. Returns the names of the former.
std::vector<std::string> TextReader::set_text_apart(std::vector<TextColumn>& columns, const TextSample& sample) const
{
    std::vector<std::string> names(columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const std::string& name = columns[c].name;
        const bool axis = name == "x" || name == "y" || name == "z";
        if (axis || name == "-" || columns[c].type || !sample.looks[c].words) continue;
        const std::string given = header_ ? header_->names[c] : name;
        if (sample.looks[c].words <= sample.looks[c].values && !names_a_label(given)) continue;
        names[c] = printable_name(given);
        if (names[c].empty()) names[c] = "column_" + std::to_string(c + 1);
        columns[c].name = "-";
    }
    return names;
}

// Lines before the first row that are neither comments nor names nor counts.
void TextReader::note_titles(const TextSample& sample, std::size_t skipped)
{
    std::size_t titles = 0, first = 0;
    for (std::size_t i = skipped; i < sample.head.size(); ++i) {
        const std::string& line = sample.head[i];
        if (i + 1 == header_line_ || is_blank_or_comment(line, sample.dialect.separator) || count_in(line)) continue;
        if (titles++ == 0) first = i;
    }
    if (titles)
        info_.notes.push_back(grouped(titles) + (titles == 1 ? " line" : " lines") + " before the first point" +
                              (titles == 1 ? " is" : " are") + " not read, the first is line " +
                              std::to_string(first + 1) + ": " + quote_bytes(sample.head[first]));
}

// Looks for a number of points in the lines before the first row, except those that the user wants skipped.
void TextReader::find_count(const std::vector<std::string>& head, std::size_t skipped)
{
    for (std::size_t i = skipped; i < head.size(); ++i)
        if (const auto count = count_in(head[i])) {
            promised_ = count;
            promise_line_ = i + 1;
        }
}

void TextReader::plan(const TextLayout& layout, const TextSample& sample)
{
    refuse_grids(sample.head);
    std::vector<TextColumn> columns = columns_of(layout, sample);
    label_names_ = set_text_apart(columns, sample);
    TextPlan plan = plan_columns(columns, sample.looks, layout.colour_range, conventions_.signed_intensity);
    find_count(sample.head, layout.skip_lines.value_or(0));
    if (auto system = crs_block_of_lines(sample.head)) info_.metadata.push_back(std::move(*system));

    info_.text_layout = layout_of(columns, plan, sample);
    std::string note = "columns " + describe(*info_.text_layout);
    if (sample.dialect.point == ',') note += ", with decimal commas";
    if (header_line_) note += ", named in line " + std::to_string(header_line_);
    if (layout.columns.empty()) note += "; the columns option overrides this";
    info_.notes.push_back(note);
    if (const std::string renamed = header_ ? header_->renamed() : std::string(); !renamed.empty())
        info_.notes.push_back("names of columns understood: " + renamed);
    if (header_ && header_->geographic)
        info_.notes.push_back("x and y are longitude and latitude, in degrees as they are in the file");
    note_titles(sample, layout.skip_lines.value_or(0));
    info_.notes.insert(info_.notes.end(), plan.notes.begin(), plan.notes.end());

    info_.points = sample.estimated_rows(file_size_);
    // A stated number is better than an estimate from some lines, unless it is impossible.
    if (promised_ && *promised_ <= file_size_ / (2 * columns.size()) + 1) info_.points = *promised_;
    start(std::move(plan), sample.dialect, sample.first_row_byte, sample.first_row);
}

// A header of columns, or a count of 0, and nothing after it: a cloud without points.
void TextReader::plan_without_rows(const TextLayout& layout)
{
    if (file_size_ == 0) fail(ErrorCode::bad_format, "the file is empty", "");
    TextDialect dialect;
    std::vector<std::string> head;
    TextSource lines(file_);
    std::string_view line;
    std::optional<std::string> odd;
    std::uint64_t odd_line = 0;
    while (!odd && lines.bytes_read() < 65536 && lines.next(line)) {
        head.emplace_back(line);
        if (is_blank_or_comment(line) || count_in(line) == std::uint64_t(0)) continue;
        for (const char separator : {',', ';', '\t', ' '})
            if (read_header(head.back(), {separator, '.'})) line = {};
        if (line.empty()) continue;
        odd = head.back();
        odd_line = lines.lines_read();
    }
    refuse_grids(head);
    std::vector<TextColumn> columns;
    bool counted = false;
    for (const std::string& text : head) {
        counted = counted || count_in(text) == std::uint64_t(0);
        if (auto header = read_header(text, dialect)) columns = header->columns;
    }
    if (odd || lines.fill() || (columns.empty() && !counted)) {
        const std::string from = layout.skip_lines ? " after line " + std::to_string(*layout.skip_lines) : "";
        fail(ErrorCode::bad_format,
             odd ? "line " + std::to_string(odd_line) + " is " + quote_bytes(*odd) +
                       ", expected lines of three numbers or more" + from
                 : "no line of three numbers or more was found" + from,
             "if detection fails, state the separator, the lines to skip and the columns");
    }
    if (columns.empty()) columns = {{"x", {}, false}, {"y", {}, false}, {"z", {}, false}};
    start(plan_columns(columns, std::vector<ColumnLook>(columns.size()), layout.colour_range,
                       conventions_.signed_intensity),
          dialect, file_size_, head.size());
}

void TextReader::start(TextPlan plan, const TextDialect& dialect, std::uint64_t byte, std::uint64_t line)
{
    for (std::size_t c = 0; c < label_names_.size(); ++c) {
        if (label_names_[c].empty()) continue;
        plan.fields[c].role = TextField::Role::text;
        plan.fields[c].name = label_names_[c];
    }
    info_.format =
        conventions_.format.empty() ? "text separated by " + separator_text(dialect) : std::string(conventions_.format);
    info_.points_known = false;
    info_.schema = plan.schema;
    info_.position_type = ScalarType::f64;
    batch_points_ = std::min(points_that_fit_a_batch(info_.schema), default_batch_points);
    source_.emplace(file_, byte, line);
    rows_.emplace(file_.path(),
                  TextForm{dialect, std::move(plan.fields), header_.has_value(), override_hint, skip_bad_lines_},
                  [this](std::uint64_t at, const auto& fields) { return begins_list(at, fields); });
}

// A line between the points that holds only a count.
bool TextReader::begins_list(std::uint64_t line, const std::vector<std::string_view>& fields)
{
    if (fields.size() != 1 || !promised_) return false;
    const auto count = count_in(fields[0]);
    if (!count) return false;
    end_list("line " + std::to_string(line) + " begins another list");
    promised_ = count;
    promise_line_ = line;
    lines_before_list_ = rows_->counts().rows + rows_->counts().bad_lines;
    return true;
}

void TextReader::end_list(const std::string& where)
{
    if (!promised_) return;
    // Some of the promised points may be on bad lines.
    const std::uint64_t found = rows_->counts().rows + rows_->counts().bad_lines - lines_before_list_;
    const std::string promise = "line " + std::to_string(promise_line_) + " promises " + points_text(*promised_);
    if (found < *promised_) fail(ErrorCode::truncated, promise + ", " + where + " after " + grouped(found), "");
    if (found > *promised_ && info_.notes.size() < 100)
        info_.notes.push_back(promise + ", " + grouped(found) + " follow; all are read");
}

void TextReader::finish()
{
    if (finished_) return;
    end_list("the file ends");
    finished_ = true;
    for (std::string& note : rows_->counts().notes()) info_.notes.push_back(std::move(note));
}

bool TextReader::read(PointBatch& batch, std::size_t max_points)
{
    const std::uint64_t left = file_size_ - std::min(file_size_, source_->bytes_read());
    const std::size_t most = finished_ ? 0 : rows_->most_rows(left, std::min(max_points, batch_points_));
    shape_batch(batch, info_.schema, false, most);
    if (most == 0) return false;
    std::size_t count = 0;
    do {
        info_.skipped.lines = rows_->counts().bad_lines;
        count = rows_->read(*source_, batch, 0, most);
    } while (count == 0 && rows_->counts().bad_lines > info_.skipped.lines);
    info_.skipped.lines = rows_->counts().bad_lines;
    if (count < most) batch.resize(count);
    if (count == 0) finish();
    return count > 0;
}

}  // namespace

std::unique_ptr<PointReader> open_text(const std::filesystem::path& path, const ReadOptions& options,
                                       const TextConventions& conventions)
{
    return std::make_unique<TextReader>(path, options, conventions);
}

bool looks_like_points(const std::filesystem::path& path)
{
    try {
        const File file(path, File::Mode::read);
        const auto sample = sample_text(file);
        // A few lines may have faults: they are for the reader to name.
        if (!sample || (sample->odd_lines + sample->longer_rows) * 10 > sample->rows) return false;
        bool named = false;
        for (const std::string& line : sample->head) {
            const bool header = read_header(line, sample->dialect).has_value();
            if (!header && !is_blank_or_comment(line, sample->dialect.separator) && !count_in(line)) return false;
            named = named || header;
        }
        // Words are in a table of anything, unless it names x, y and z.
        const auto holds_words = [](const ColumnLook& look) { return look.words > look.values; };
        return named || std::none_of(sample->looks.begin(), sample->looks.end(), holds_words);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::bad_format || error.code() == ErrorCode::unsupported) return false;
        throw;
    }
}

}  // namespace pcm
