#include "pcm/io/text/text_reader.h"

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/file_text.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/text/parse_number.h"
#include "pcm/io/text/text_columns.h"
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
    "if these are not the columns, name them, for example \"x y z intensity r g b\" or with types \"x y z id:u64 "
    "intensity:f64\"; a column - is skipped";

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
    void start(const TextPlan& plan, const TextDialect& dialect, bool has_header, std::uint64_t byte,
               std::uint64_t line);
    void find_count(const std::vector<std::string>& head, std::size_t skipped);
    std::vector<TextColumn> columns_of(const TextLayout& layout, const TextSample& sample);
    std::optional<std::vector<TextColumn>> find_header(const TextSample& sample);
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
    std::size_t header_line_ = 0;  // counted from 1; 0 without
    // The current list of points, as its first line states it.
    std::optional<std::uint64_t> promised_;
    std::uint64_t promise_line_ = 0;
    std::uint64_t rows_before_list_ = 0;
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

std::optional<std::vector<TextColumn>> TextReader::find_header(const TextSample& sample)
{
    for (std::size_t i = sample.head.size(); i-- > 0;)
        if (auto columns = header_columns(sample.head[i], sample.dialect)) {
            header_line_ = i + 1;
            return columns;
        }
    for (std::size_t i = 0; i < sample.head.size(); ++i)
        if (!is_blank_or_comment(sample.head[i]) && is_half_a_header(sample.head[i], sample.dialect))
            fail(ErrorCode::bad_format, "line " + std::to_string(i + 1) + " is " + quote_bytes(sample.head[i]) +
                                            ", expected the names of the columns with x, y and z once each");
    return std::nullopt;
}

std::vector<TextColumn> TextReader::columns_of(const TextLayout& layout, const TextSample& sample)
{
    const std::string first = "line " + std::to_string(sample.first_row + 1);
    std::vector<TextColumn> columns;
    if (!layout.columns.empty()) {
        for (const std::string& column : layout.columns) {
            const NamedColumn named = named_column(column);
            columns.push_back({named.name, named.type, false});
        }
        if (columns.size() != sample.columns)
            fail(ErrorCode::bad_format, std::to_string(columns.size()) + " columns were named, most lines from " +
                                            first + " on have " + std::to_string(sample.columns));
        return columns;
    }
    if (auto header = find_header(sample)) {
        if (header->size() != sample.columns)
            fail(ErrorCode::bad_format, "line " + std::to_string(header_line_) + " names " +
                                            std::to_string(header->size()) + " columns, most lines from " + first +
                                            " on have " + std::to_string(sample.columns));
        return *header;
    }
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
    const std::vector<TextColumn> columns = columns_of(layout, sample);
    TextPlan plan = plan_columns(columns, sample.looks, layout.colour_range, conventions_.signed_intensity);
    find_count(sample.head, layout.skip_lines.value_or(0));
    if (auto system = crs_block_of_lines(sample.head)) info_.metadata.push_back(std::move(*system));

    info_.text_layout = layout_of(columns, plan, sample);
    std::string note = "columns " + describe(*info_.text_layout);
    if (sample.dialect.point == ',') note += ", with decimal commas";
    if (header_line_) note += ", named in line " + std::to_string(header_line_);
    if (layout.columns.empty()) note += "; the columns option overrides this";
    info_.notes.push_back(note);
    info_.notes.insert(info_.notes.end(), plan.notes.begin(), plan.notes.end());

    info_.points = sample.estimated_rows(file_size_);
    // A stated number is better than an estimate from some lines, unless it is impossible.
    if (promised_ && *promised_ <= file_size_ / (2 * columns.size()) + 1) info_.points = *promised_;
    start(plan, sample.dialect, header_line_ != 0, sample.first_row_byte, sample.first_row);
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
            if (header_columns(head.back(), {separator, '.'})) line = {};
        if (line.empty()) continue;
        odd = head.back();
        odd_line = lines.lines_read();
    }
    refuse_grids(head);
    std::vector<TextColumn> columns;
    bool counted = false;
    for (const std::string& text : head) {
        counted = counted || count_in(text) == std::uint64_t(0);
        if (auto header = header_columns(text, dialect)) columns = *header;
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
    const TextPlan plan = plan_columns(columns, std::vector<ColumnLook>(columns.size()), layout.colour_range,
                                       conventions_.signed_intensity);
    start(plan, dialect, false, file_size_, head.size());
}

void TextReader::start(const TextPlan& plan, const TextDialect& dialect, bool has_header, std::uint64_t byte,
                       std::uint64_t line)
{
    info_.format =
        conventions_.format.empty() ? "text separated by " + separator_text(dialect) : std::string(conventions_.format);
    info_.points_known = false;
    info_.schema = plan.schema;
    info_.position_type = ScalarType::f64;
    batch_points_ = std::min(points_that_fit_a_batch(info_.schema), default_batch_points);
    source_.emplace(file_, byte, line);
    rows_.emplace(file_.path(), TextForm{dialect, plan.fields, has_header, override_hint},
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
    rows_before_list_ = rows_->counts().rows;
    return true;
}

void TextReader::end_list(const std::string& where)
{
    if (!promised_) return;
    const std::uint64_t found = rows_->counts().rows - rows_before_list_;
    const std::string promise =
        "line " + std::to_string(promise_line_) + " promises " + grouped(*promised_) + " points";
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
    const std::size_t count = rows_->read(*source_, batch, 0, most);
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
        if (!sample || sample->odd_lines || sample->longer_rows) return false;
        for (const std::string& line : sample->head)
            if (!is_blank_or_comment(line) && !count_in(line) && !header_columns(line, sample->dialect)) return false;
        return true;
    } catch (const Error& error) {
        if (error.code() == ErrorCode::bad_format || error.code() == ErrorCode::unsupported) return false;
        throw;
    }
}

}  // namespace pcm
