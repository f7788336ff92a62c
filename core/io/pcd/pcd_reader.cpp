#include "pcm/io/pcd/pcd_reader.h"

#include "pcm/io/file_text.h"
#include "pcm/io/pcd/lzf_stream.h"
#include "pcm/io/pcd/pcd_header.h"
#include "pcm/io/pcd/pcd_plan.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/records/line_stream.h"
#include "pcm/io/records/line_words.h"
#include "pcm/io/records/scalars.h"
#include "pcm/io/records/stored_values.h"
#include "pcm/system/file.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t tile_bytes = std::size_t{256} << 10;  // read at once and decoded while in the cache

// Copies `count` values of a field, `stride` bytes apart, to columns of the batch from point `first` on. Returns how
// many are beyond the type of their attribute.
std::uint64_t unpack(const PcdPlan& plan, const Schema& schema, const PcdTarget& target, const std::byte* from,
                     std::size_t stride, std::size_t count, PointBatch& batch, std::size_t first)
{
    if (target.kind == PcdTarget::Kind::axis) {
        double* const to = batch.xyz[target.index].data() + first;
        with_type(target.type, [&](auto example) { widen<decltype(example)>(from, stride, count, to); });
        if (plan.shift)
            for (std::size_t i = 0; i < count; ++i)
                to[i] = coordinate_of_float(plan.grid, target.index, static_cast<float>(to[i]),
                                            (*plan.shift)[target.index]);
        return 0;
    }
    Column& column = batch.attributes[target.index];
    const std::size_t to_stride = column.point_bytes();
    std::byte* to = column.data() + first * to_stride + target.byte;
    if (target.kind == PcdTarget::Kind::packed_colour) {
        for (std::size_t i = 0; i < count; ++i) {
            const auto colour = load_scalar<std::uint32_t>(from + i * stride);
            for (std::size_t c = 0; c < 3; ++c) {
                const std::uint32_t byte = colour >> (16 - 8 * c) & 255u;
                if (target.step)
                    column.as<std::uint16_t>()[3 * (first + i) + c] = static_cast<std::uint16_t>(byte * target.step);
                else
                    column.as<std::uint8_t>()[3 * (first + i) + c] = static_cast<std::uint8_t>(byte);
            }
            if (target.alpha)
                batch.attributes[*target.alpha].as<std::uint8_t>()[first + i] = static_cast<std::uint8_t>(colour >> 24);
        }
        return 0;
    }
    if (target.kind == PcdTarget::Kind::scalars) {
        copy_scalars(target.bytes, from, stride, count, to, to_stride);
        return 0;
    }
    std::uint64_t beyond = 0;
    const Attribute& attribute = schema[target.index];
    for (std::size_t done = 0; done < target.bytes; done += size_of(target.type), to += size_of(attribute.type))
        beyond += restore_values(attribute, target.type, 0, false, from + done, stride, count, to, to_stride);
    return beyond;
}

class PcdReader final : public PointReader {
public:
    explicit PcdReader(const std::filesystem::path& path)
        : file_(path, File::Mode::read), file_size_(file_.size()), header_(read_pcd_header(file_))
    {
        info_.notes = header_.notes;
        info_.points = header_.points;
        plan_ = plan_pcd(path, header_, info_);
        beyond_.resize(info_.schema.size());
        check_bytes_hold_the_points();
        describe();
        batch_points_ = points_that_fit_a_batch(info_.schema);
    }

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return header_.encoding == PcdHeader::Encoding::binary; }
    void seek(std::uint64_t index) override;
    double fraction_read() const override;

private:
    [[noreturn]] void fail(ErrorCode code, const std::string& what) const { throw Error(code, file_.path(), what); }
    [[noreturn]] void fail_line(ErrorCode code, const std::string& what) const
    {
        fail(code, "line " + std::to_string(lines_->line_number()) + ": " + what);
    }
    std::uint64_t left() const { return file_size_ - std::min(header_.bytes, file_size_); }

    void check_bytes_hold_the_points();
    void check_compressed();
    void describe();

    void start();
    void take(const PcdTarget& target, const std::byte* from, std::size_t stride, std::size_t count, PointBatch& batch,
              std::size_t first)
    {
        const std::uint64_t beyond = unpack(plan_, info_.schema, target, from, stride, count, batch, first);
        if (beyond) beyond_[target.index] += beyond;
    }
    void read_records(PointBatch& batch, std::size_t count);
    void read_columns(PointBatch& batch, std::size_t count);
    void note_rest();
    void read_line(std::byte* record);
    std::uint32_t colour_of(LineWords& words, const PcdField& field, std::string_view& word) const;

    File file_;
    std::uint64_t file_size_;
    PcdHeader header_;
    FileInfo info_;
    PcdPlan plan_;
    std::vector<std::uint64_t> beyond_;  // values that are not in the range of the attribute's type
    std::size_t batch_points_ = 1;
    std::uint64_t compressed_bytes_ = 0;
    bool padding_compressed_ = false;  // whether the compressed block has columns for "_"

    std::uint64_t next_ = 0;
    bool started_ = false;
    std::optional<LineStream> lines_;
    std::vector<LzfStream> columns_;  // streams of the fields with a target
    std::vector<std::byte> buffer_;
};

void PcdReader::check_compressed()
{
    if (header_.points == 0) return;
    std::array<std::byte, 8> sizes{};
    if (left() < sizes.size())
        fail(ErrorCode::truncated, "the file ends at byte " + std::to_string(file_size_) +
                                       "; the sizes of the compressed block were expected at byte " +
                                       std::to_string(header_.bytes));
    file_.read_at(sizes.data(), sizes.size(), header_.bytes);
    compressed_bytes_ = load_scalar<std::uint32_t>(sizes.data());
    const std::uint64_t whole = load_scalar<std::uint32_t>(sizes.data() + 4);
    if (compressed_bytes_ > left() - sizes.size())
        fail(ErrorCode::truncated, "the compressed block at byte " + std::to_string(header_.bytes) + " has " +
                                       std::to_string(compressed_bytes_) + " bytes; the file has " +
                                       std::to_string(left() - sizes.size()) + " from there on");
    // PCL omits padding from compressed files but may name it in the header.
    std::uint64_t plain = 0;
    for (const PcdField& field : header_.fields) plain += field.is_padding() ? 0 : field.bytes();
    const auto is = [&](std::uint64_t record) {
        return record && whole % record == 0 && whole / record == header_.points;
    };
    padding_compressed_ = !is(plain);
    if (padding_compressed_ && !is(plan_.record_bytes))
        fail(ErrorCode::bad_format, "byte " + std::to_string(header_.bytes + 4) + ": the compressed block holds " +
                                        std::to_string(whole) + " bytes, expected " + std::to_string(header_.points) +
                                        " points of " + std::to_string(plain) + " bytes");
    if (whole > compressed_bytes_ * lzf_most_expansion)
        fail(ErrorCode::corrupt, "byte " + std::to_string(header_.bytes) + ": " + std::to_string(compressed_bytes_) +
                                     " compressed bytes cannot expand to the stated " + std::to_string(whole));
    if (left() - sizes.size() > compressed_bytes_)
        info_.notes.push_back(std::to_string(left() - sizes.size() - compressed_bytes_) +
                              " bytes after the compressed block are ignored");
}

void PcdReader::check_bytes_hold_the_points()
{
    if (header_.encoding == PcdHeader::Encoding::compressed) return check_compressed();
    const bool ascii = header_.encoding == PcdHeader::Encoding::ascii;
    // In ascii a number takes a digit and a separator; the last one of the file may have none.
    const std::uint64_t least = ascii ? 2 * header_.numbers() : plan_.record_bytes;
    if (header_.points > (left() + (ascii ? 1 : 0)) / least)
        fail(ErrorCode::truncated, "the header promises " + std::to_string(header_.points) + " points of at least " +
                                       std::to_string(least) + " bytes; from byte " + std::to_string(header_.bytes) +
                                       " to the end of the file there are " + std::to_string(left()));
    if (const std::uint64_t more = left() - header_.points * least; !ascii && more)
        info_.notes.push_back(std::to_string(more) + " bytes after the last point are ignored");
}

void PcdReader::describe()
{
    static constexpr const char* encodings[] = {"ascii", "binary", "binary_compressed"};
    info_.format = "PCD " + (header_.version.empty() ? std::string() : printable_name(header_.version) + " ") +
                   encodings[static_cast<std::size_t>(header_.encoding)];
    if (header_.height > 1)
        info_.notes.push_back("organised as " + std::to_string(header_.width) + " x " + std::to_string(header_.height));
    if (header_.viewpoint.empty() || plan_.viewpoint_is_shift) return;
    const auto* bytes = reinterpret_cast<const std::byte*>(header_.viewpoint.data());
    info_.metadata.push_back({"pcd.viewpoint", {bytes, bytes + header_.viewpoint.size()}});
}

// Finds the start of each column in the compressed block by decoding it once. This also proves it sound before any
// point is returned.
void PcdReader::start()
{
    started_ = true;
    if (header_.encoding == PcdHeader::Encoding::ascii) lines_.emplace(file_, header_.bytes, header_.lines);
    if (header_.encoding != PcdHeader::Encoding::compressed || header_.points == 0) return;
    const std::uint64_t begin = header_.bytes + 8;
    LzfStream stream(file_, begin, begin + compressed_bytes_);
    for (std::size_t i = 0; i < plan_.targets.size(); ++i) {
        if (plan_.targets[i].kind != PcdTarget::Kind::none) columns_.push_back(stream);
        if (padding_compressed_ || !header_.fields[i].is_padding())
            stream.take(nullptr, header_.points * plan_.targets[i].bytes);
    }
    if (!stream.at_end())
        fail(ErrorCode::corrupt, "byte " + std::to_string(begin) + ": the " + std::to_string(compressed_bytes_) +
                                     " compressed bytes hold more than the stated number of points");
}

// A packed colour is a bit pattern, whatever its type. As text, such a real is either the number with these bits or, in
// files of early programs, the bits as a whole number. The two cannot be confused: a colour without alpha has the bits
// of a real below 1e-37, never of 1 or more.
std::uint32_t PcdReader::colour_of(LineWords& words, const PcdField& field, std::string_view& word) const
{
    std::array<std::byte, 8> raw{};
    const bool real = field.type == ScalarType::f32;
    if (!words.next_number(real ? ScalarType::f32 : ScalarType::i64, raw.data(), word))
        fail_line(ErrorCode::bad_format, "found " + quote_bytes(word) + ", expected the colour '" + field.name + "'");
    if (real) {
        const auto value = load_scalar<float>(raw.data());
        if (value >= 1 && value <= 16777215 && value == std::floor(value)) return static_cast<std::uint32_t>(value);
        return load_scalar<std::uint32_t>(raw.data());
    }
    const auto bits = load_scalar<std::int64_t>(raw.data());
    if (bits < INT32_MIN || bits > UINT32_MAX)
        fail_line(ErrorCode::bad_format,
                  "found the colour " + std::to_string(bits) + " for '" + field.name + "', expected 32 bits");
    return static_cast<std::uint32_t>(bits);
}

// One ascii point; its fields go to `record` as in a binary file.
void PcdReader::read_line(std::byte* record)
{
    std::string_view line;
    if (!lines_->next(line))
        fail_line(ErrorCode::truncated,
                  "the file ends after " + std::to_string(next_) + " of " + std::to_string(info_.points) + " points");
    LineWords words(line, true);
    std::string_view word;
    for (std::size_t i = 0; i < plan_.targets.size(); ++i) {
        const PcdField& field = header_.fields[i];
        const PcdTarget& target = plan_.targets[i];
        std::byte* to = record + target.offset;
        if (words.at_end() && field.count)
            fail_line(ErrorCode::bad_format,
                      "found " + quote_bytes(line) + ", which ends before the field '" + field.name + "'");
        if (target.kind == PcdTarget::Kind::packed_colour) {
            const std::uint32_t colour = colour_of(words, field, word);
            std::memcpy(to, &colour, sizeof colour);
            continue;
        }
        for (std::uint32_t k = 0; k < field.count; ++k, to += size_of(field.type)) {
            const bool found = target.kind == PcdTarget::Kind::none ? !(word = words.next()).empty()
                                                                    : words.next_number(field.type, to, word);
            if (found) continue;
            if (word.empty())
                fail_line(ErrorCode::bad_format,
                          "found " + quote_bytes(line) + ", which ends within the field '" + field.name + "'");
            fail_line(ErrorCode::bad_format, "found " + quote_bytes(word) + " for the field '" + field.name +
                                                 "', expected a number of type " + std::string(name_of(field.type)));
        }
    }
    if (const std::string_view more = words.next(); !more.empty())
        fail_line(ErrorCode::bad_format,
                  "found " + quote_bytes(more) + " after the last field, expected the end of the line");
}

void PcdReader::read_records(PointBatch& batch, std::size_t count)
{
    const bool ascii = header_.encoding == PcdHeader::Encoding::ascii;
    const std::size_t tile = std::max<std::size_t>(1, (ascii ? tile_bytes / 16 : tile_bytes) / plan_.record_bytes);
    buffer_.resize(std::min(tile, count) * plan_.record_bytes);
    for (std::size_t done = 0; done < count;) {
        const std::size_t now = std::min(tile, count - done);
        if (ascii) {
            for (std::size_t i = 0; i < now; ++i, ++next_) read_line(buffer_.data() + i * plan_.record_bytes);
        } else {
            file_.read_at(buffer_.data(), now * plan_.record_bytes, header_.bytes + next_ * plan_.record_bytes);
            next_ += now;
        }
        for (const PcdTarget& target : plan_.targets)
            if (target.kind != PcdTarget::Kind::none)
                take(target, buffer_.data() + target.offset, plan_.record_bytes, now, batch, done);
        done += now;
    }
}

void PcdReader::read_columns(PointBatch& batch, std::size_t count)
{
    auto column = columns_.begin();
    for (const PcdTarget& target : plan_.targets) {
        if (target.kind == PcdTarget::Kind::none) continue;
        const std::size_t tile = std::max<std::size_t>(1, tile_bytes / 16 / target.bytes);
        buffer_.resize(std::min(tile, count) * target.bytes);
        for (std::size_t done = 0; done < count;) {
            const std::size_t now = std::min(tile, count - done);
            column->take(buffer_.data(), now * target.bytes);
            take(target, buffer_.data(), target.bytes, now, batch, done);
            done += now;
        }
        ++column;
    }
    next_ += count;
}

// Ascii: lines after the promised points.
void PcdReader::note_rest()
{
    if (const auto rest = describe_rest(*lines_))
        info_.notes.push_back(*rest + "; the header promises " + points_text(info_.points));
}

bool PcdReader::read(PointBatch& batch, std::size_t max_points)
{
    if (!started_) start();
    const auto count = static_cast<std::size_t>(
        std::min<std::uint64_t>(info_.points - next_, std::min(std::max<std::size_t>(max_points, 1), batch_points_)));
    shape_batch(batch, info_.schema, false, count);
    if (count == 0 && lines_) note_rest();  // the file promises no points
    if (count == 0) return false;
    if (header_.encoding == PcdHeader::Encoding::compressed)
        read_columns(batch, count);
    else
        read_records(batch, count);
    if (next_ == info_.points) note_values_beyond(info_.schema, beyond_, info_.notes);
    if (lines_ && next_ == info_.points) note_rest();
    return true;
}

void PcdReader::seek(std::uint64_t index)
{
    if (!seekable()) return PointReader::seek(index);
    if (index > info_.points)
        fail(ErrorCode::invalid_argument,
             "point " + std::to_string(index) + " was requested, the file has " + std::to_string(info_.points));
    next_ = index;
}

double PcdReader::fraction_read() const
{
    if (next_ == info_.points) return 1.0;
    return static_cast<double>(next_) / static_cast<double>(info_.points);
}

}  // namespace

std::unique_ptr<PointReader> open_pcd(const std::filesystem::path& path, const ReadOptions&)
{
    return std::make_unique<PcdReader>(path);
}

}  // namespace pcm
