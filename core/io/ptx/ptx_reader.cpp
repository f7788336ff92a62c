#include "pcm/io/ptx/ptx_reader.h"

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
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace pcm {
namespace {

// Files up to this size are searched for their scans before points are read.
constexpr std::uint64_t look_through_bytes = std::uint64_t{128} << 20;
constexpr std::size_t header_lines = 10;
constexpr std::array<std::size_t, header_lines> header_fields = {1, 1, 3, 3, 3, 3, 4, 4, 4, 4};
constexpr std::array<const char*, header_lines> header_names = {
    "the number of columns",   "the number of rows",     "the scanner's position",  "the scanner's x axis",
    "the scanner's y axis",    "the scanner's z axis",   "line 1 of the transform", "line 2 of the transform",
    "line 3 of the transform", "line 4 of the transform"};
constexpr std::size_t most_noted_metadata = 10000;
// The last column of a transform is 0 0 0 1 up to this: less than a double keeps of the other columns.
constexpr double most_projective = 1e-12;

struct Scan {
    std::uint64_t points = 0;  // columns x rows
    std::array<std::array<double, 4>, 4> transform{};
    std::uint64_t first_line = 0;
    std::string text;
};

struct HeaderFault {
    bool ended = false;  // the file ends
    std::uint64_t line = 0;
    std::string what;
};

bool next_filled_line(TextSource& source, std::string_view& line)
{
    while (source.next(line))
        if (line.find_first_not_of(" \t") != std::string_view::npos) return true;
    return false;
}

// The ten lines before a scan. Null at the end of the file, and, with `fault` set, when other lines are found.
std::optional<Scan> read_scan_header(TextSource& source, std::optional<HeaderFault>& fault)
{
    Scan scan;
    std::array<std::uint64_t, 2> size{};
    std::vector<std::string_view> words;
    for (std::size_t i = 0; i < header_lines; ++i) {
        std::string_view line;
        if (!next_filled_line(source, line)) {
            if (i > 0) fault = {true, source.lines_read(), "the file ends before " + std::string(header_names[i])};
            return std::nullopt;
        }
        split_fields(line, {}, words);
        bool good = words.size() == header_fields[i];
        for (std::size_t w = 0; good && w < words.size(); ++w) {
            double value = 0;
            good = i < 2 ? text::parse_number(words[w], size[i])
                         : text::parse_number(words[w], value) && std::isfinite(value);
            if (good && i >= 6) scan.transform[i - 6][w] = value;
        }
        if (good && i >= 6 && !(std::fabs(scan.transform[i - 6][3] - (i == 9 ? 1 : 0)) <= most_projective)) {
            fault = {false, source.lines_read(),
                     "found " + quote_bytes(line) + ", whose last number is not " + (i == 9 ? "1" : "0") + ": " +
                         header_names[i] + " is projective, or stands in columns instead of lines"};
            return std::nullopt;
        }
        if (!good) {
            fault = {false, source.lines_read(),
                     "found " + quote_bytes(line) + ", expected " + header_names[i] + ", " +
                         (i < 2 ? "one whole number" : std::to_string(header_fields[i]) + " numbers")};
            return std::nullopt;
        }
        if (i == 0) scan.first_line = source.lines_read();
        scan.text += std::string(line) + "\n";
    }
    if (size[0] && size[1] > UINT64_MAX / size[0]) {
        fault = {false, scan.first_line,
                 "a scan of " + std::to_string(size[0]) + " columns and " + std::to_string(size[1]) +
                     " rows holds no points"};
        return std::nullopt;
    }
    scan.points = size[0] * size[1];
    return scan;
}

class PtxReader final : public PointReader {
public:
    PtxReader(const std::filesystem::path& path, bool skip_bad_lines)
        : file_(path, File::Mode::read), file_size_(file_.size()), skip_bad_lines_(skip_bad_lines), source_(file_)
    {
        look_through();
        plan();
        info_.format = "PTX";
        info_.points_known = false;
        batch_points_ = std::min(points_that_fit_a_batch(info_.schema), default_batch_points);
    }

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    double fraction_read() const override
    {
        return finished_ || !file_size_ ? 1.0
                                        : static_cast<double>(source_.bytes_read()) / static_cast<double>(file_size_);
    }

private:
    [[noreturn]] void fail(ErrorCode code, const std::string& what) const { throw Error(code, file_.path(), what); }
    [[noreturn]] void fail(const HeaderFault& fault) const
    {
        fail(fault.ended ? ErrorCode::truncated : ErrorCode::bad_format,
             "line " + std::to_string(fault.line) + ": " + fault.what);
    }
    void look_through();
    void keep_metadata(std::size_t number, const Scan& scan);
    void plan();
    bool begin_scan();
    std::size_t fields_here();
    [[noreturn]] void end_early(std::uint64_t line, const std::string& found) const;
    std::size_t into_world(PointBatch& batch, std::size_t first, std::size_t count);
    void finish();

    File file_;
    std::uint64_t file_size_;
    bool skip_bad_lines_;
    TextSource source_;
    FileInfo info_;
    std::vector<ColumnLook> looks_;  // for the columns of the first rows
    std::size_t sampled_fields_ = 0;
    bool has_rgb_ = false, has_intensity_ = false, has_scan_ = false;
    TextPlan plan_;
    std::size_t scan_attribute_ = 0;
    std::size_t batch_points_ = 1;

    std::optional<Scan> scan_;
    std::size_t scan_number_ = 0;  // from 1
    std::uint64_t left_ = 0;       // lines left of the scan
    std::optional<TextRows> rows_;
    std::vector<std::size_t> absent_;  // attributes that lines of this scan do not have
    std::uint64_t missing_returns_ = 0, lines_ = 0;
    TextCounts counts_;  // counts of the scans that have been read completely
    bool finished_ = false;
};

// Finds all scans of a small file, the first scan of a large one.
void PtxReader::look_through()
{
    if (file_size_ == 0) fail(ErrorCode::bad_format, "the file is empty");
    TextSource source(file_);
    std::optional<HeaderFault> fault;
    std::vector<std::string_view> words;
    std::size_t scans = 0, bytes_of_metadata = 0;
    std::uint64_t promised = 0;
    has_scan_ = file_size_ > look_through_bytes;
    while (const auto scan = read_scan_header(source, fault)) {
        ++scans;
        promised += std::min(scan->points, UINT64_MAX - promised);
        bytes_of_metadata += scan->text.size();
        if (bytes_of_metadata < (std::size_t{16} << 20)) keep_metadata(scans, *scan);
        std::string_view line;
        for (std::uint64_t i = 0; i < scan->points; ++i) {
            const std::uint64_t at = source.bytes_read();
            if (!next_filled_line(source, line)) break;
            if (i > 0) continue;
            split_fields(line, {}, words);
            const std::size_t fields = words.size();
            if (fields != 3 && fields != 4 && fields != 6 && fields != 7)
                fail(ErrorCode::bad_format, "line " + std::to_string(source.lines_read()) + ": found " +
                                                quote_bytes(line) +
                                                ", expected x y z intensity, or x y z intensity r g b");
            has_intensity_ = has_intensity_ || fields % 3 == 1;
            has_rgb_ = has_rgb_ || fields >= 6;
            if (sampled_fields_ < fields) {
                sampled_fields_ = fields;
                looks_ = sample_rows(file_, {}, fields, at).looks;
            }
            if (file_size_ > look_through_bytes) break;
        }
        if (file_size_ > look_through_bytes) break;
    }
    // Errors after the first scan are reported when they are read.
    if (scans == 0) fail(fault ? *fault : HeaderFault{true, source.lines_read(), "the file has no scan"});
    has_scan_ = has_scan_ || scans > 1;
    info_.points = std::min(promised, file_size_ / 6 + 1);
}

void PtxReader::keep_metadata(std::size_t number, const Scan& scan)
{
    if (number != info_.metadata.size() + 1 || number > most_noted_metadata) return;
    Metadata block{"ptx.scan/" + std::to_string(number), std::vector<std::byte>(scan.text.size())};
    std::memcpy(block.value.data(), scan.text.data(), scan.text.size());
    info_.metadata.push_back(std::move(block));
}

// One schema for all scans, with types from the sampled columns.
void PtxReader::plan()
{
    std::vector<TextColumn> columns = {{"x", {}, false}, {"y", {}, false}, {"z", {}, false}};
    if (has_intensity_) columns.push_back({"intensity", ScalarType::f32, false});
    if (has_rgb_)
        for (const char* name : {"r", "g", "b"}) columns.push_back({name, {}, false});
    std::vector<ColumnLook> looks(columns.size());
    // The longest lines were sampled; those of 6 fields have no intensity.
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const std::size_t from = sampled_fields_ == 6 && has_intensity_ && c > 3 ? c - 1 : c;
        if (from < looks_.size()) looks[c] = looks_[from];
    }
    if (has_intensity_ && !looks[3].single) columns[3].type = ScalarType::f64;
    plan_ = plan_columns(columns, looks, std::nullopt, false);
    info_.schema = plan_.schema;
    info_.notes.insert(info_.notes.end(), plan_.notes.begin(), plan_.notes.end());
    info_.position_type = ScalarType::f64;
    if (has_scan_) {
        scan_attribute_ = info_.schema.size();
        info_.schema.add({"scan", ScalarType::u32, 1, 1, 0, {}});
    }
}

// The fields of the next line that is not blank.
std::size_t PtxReader::fields_here()
{
    std::vector<std::string_view> words;
    while (source_.fill()) {
        const char* at = source_.at();
        split_fields(take_line(at), {}, words);
        if (!words.empty()) return words.size();
        source_.advance(at, 1);
    }
    return 0;
}

bool PtxReader::begin_scan()
{
    std::optional<HeaderFault> fault;
    scan_ = read_scan_header(source_, fault);
    if (fault) fail(*fault);
    if (!scan_) return false;
    if (++scan_number_ > UINT32_MAX) fail(ErrorCode::unsupported, "the file has more scans than can be counted");
    keep_metadata(scan_number_, *scan_);
    left_ = scan_->points;

    const std::size_t fields = left_ ? fields_here() : 4;
    TextForm form;
    form.fields.assign(plan_.fields.begin(), plan_.fields.begin() + 3);
    std::vector<bool> present(info_.schema.size());
    if (has_scan_) present[scan_attribute_] = true;
    const auto add = [&](const char* name, std::size_t count, bool planned, std::size_t at) {
        for (std::size_t k = 0; k < count; ++k) {
            form.fields.push_back(planned ? plan_.fields[at + k] : TextField{});
            if (planned) present[plan_.fields[at + k].index] = true;
        }
        // In a large file only the first scan is known in advance.
        if (!planned)
            info_.notes.push_back("scan " + std::to_string(scan_number_) + ": " + name + " of " + grouped(left_) +
                                  " points is not read: the first scan has none");
    };
    if (fields == 4 || fields == 7) add("intensity", 1, has_intensity_, 3);
    if (fields == 6 || fields == 7) add("colour", 3, has_rgb_, has_intensity_ ? 4 : 3);
    absent_.clear();
    for (std::size_t i = 0; i < present.size(); ++i)
        if (!present[i]) absent_.push_back(i);
    form.skip_bad_lines = skip_bad_lines_;
    if (rows_) counts_.add(rows_->counts());
    rows_.emplace(file_.path(), std::move(form), [this](std::uint64_t line, const auto& words) {
        std::uint64_t number = 0;
        if (words.size() == 1 && (!skip_bad_lines_ || text::parse_number(words[0], number))) {
            lines_ = rows_->counts().rows + rows_->counts().bad_lines;
            end_early(line, "found " + quote_bytes(words[0]) + ", as another scan begins");
        }
        return false;
    });
    return true;
}

void PtxReader::end_early(std::uint64_t line, const std::string& found) const
{
    fail(ErrorCode::truncated, "line " + std::to_string(line) + ": " + found + ", after " + grouped(lines_) +
                                   " of the " + grouped(scan_->points) + " points that scan " +
                                   std::to_string(scan_number_) + " promises in line " +
                                   std::to_string(scan_->first_line));
}

// Drops the missing returns from row `first` of the batch on and transforms the others; returns how many remain.
std::size_t PtxReader::into_world(PointBatch& batch, std::size_t first, std::size_t count)
{
    const auto& m = scan_->transform;
    double *x = batch.xyz[0].data(), *y = batch.xyz[1].data(), *z = batch.xyz[2].data();
    std::size_t to = first;
    for (std::size_t i = first; i < first + count; ++i) {
        const Vec3d p = {x[i], y[i], z[i]};
        if (p[0] == 0 && p[1] == 0 && p[2] == 0) continue;
        x[to] = p[0] * m[0][0] + p[1] * m[1][0] + p[2] * m[2][0] + m[3][0];
        y[to] = p[0] * m[0][1] + p[1] * m[1][1] + p[2] * m[2][1] + m[3][1];
        z[to] = p[0] * m[0][2] + p[1] * m[1][2] + p[2] * m[2][2] + m[3][2];
        if (to != i)
            for (Column& column : batch.attributes) {
                const std::size_t bytes = column.point_bytes();
                std::memcpy(column.data() + to * bytes, column.data() + i * bytes, bytes);
            }
        ++to;
    }
    missing_returns_ += first + count - to;
    for (const std::size_t a : absent_) {
        const std::size_t bytes = batch.attributes[a].point_bytes();
        std::memset(batch.attributes[a].data() + first * bytes, 0, (to - first) * bytes);
    }
    if (has_scan_)
        std::fill(batch.attributes[scan_attribute_].as<std::uint32_t>() + first,
                  batch.attributes[scan_attribute_].as<std::uint32_t>() + to, static_cast<std::uint32_t>(scan_number_));
    return to - first;
}

void PtxReader::finish()
{
    if (finished_) return;
    finished_ = true;
    if (missing_returns_)
        info_.notes.push_back(grouped(missing_returns_) +
                              (missing_returns_ == 1 ? " missing return" : " missing returns") + " (0 0 0) dropped");
    if (rows_) counts_.add(rows_->counts());
    for (std::string& note : counts_.notes()) info_.notes.push_back(std::move(note));
}

bool PtxReader::read(PointBatch& batch, std::size_t max_points)
{
    const std::uint64_t bytes = file_size_ - std::min(file_size_, source_.bytes_read());
    const auto most = finished_ ? 0
                                : static_cast<std::size_t>(std::min<std::uint64_t>(
                                      bytes / 6 + 1, std::min(std::max<std::size_t>(max_points, 1), batch_points_)));
    shape_batch(batch, info_.schema, false, most);
    std::size_t count = 0;
    while (count < most) {
        if (left_ == 0) {
            if (!begin_scan()) break;
            continue;
        }
        const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(most - count, left_));
        const std::size_t got = rows_->read(source_, batch, count, wanted);
        const std::uint64_t bad = counts_.bad_lines + rows_->counts().bad_lines - info_.skipped.lines;
        info_.skipped.lines += bad;
        lines_ = rows_->counts().rows + rows_->counts().bad_lines;
        if (got + bad < wanted) end_early(source_.lines_read() + 1, "the file ends");
        left_ -= wanted;
        count += into_world(batch, count, got);
    }
    if (count == 0 && most) finish();
    batch.resize(count);
    return count > 0;
}

}  // namespace

std::unique_ptr<PointReader> open_ptx(const std::filesystem::path& path, const ReadOptions& options)
{
    return std::make_unique<PtxReader>(path, options.skip_bad_lines);
}

bool looks_like_ptx(const std::filesystem::path& path)
{
    const File file(path, File::Mode::read);
    // The ten lines are short; a long line is something else.
    std::array<char, 4096> start{};
    const std::size_t got = file.read_some_at(start.data(), start.size(), 0);
    std::string_view rest(start.data(), got);
    if (rest.substr(0, 3) == "\xEF\xBB\xBF") rest.remove_prefix(3);
    std::vector<std::string_view> words;
    for (std::size_t i = 0; i < header_lines;) {
        const std::size_t stop = rest.find_first_of("\r\n");
        if (stop == std::string_view::npos && got == start.size()) return false;
        split_fields(rest.substr(0, stop), {}, words);
        if (!words.empty()) {
            if (words.size() != header_fields[i]) return false;
            double value = 0;
            std::uint64_t size = 0;
            for (const std::string_view word : words)
                if (!(i < 2 ? text::parse_number(word, size) : text::parse_number(word, value))) return false;
            ++i;
        }
        if (stop == std::string_view::npos) return i == header_lines;
        rest.remove_prefix(stop + 1);
    }
    return true;
}

}  // namespace pcm
