#include "pcm/io/ply/ply_reader.h"

#include "pcm/io/file_text.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/ply/byte_stream.h"
#include "pcm/io/ply/ply_header.h"
#include "pcm/io/ply/ply_notes.h"
#include "pcm/io/ply/ply_plan.h"
#include "pcm/io/records/line_stream.h"
#include "pcm/io/records/line_words.h"
#include "pcm/io/records/scalars.h"
#include "pcm/io/records/stored_values.h"
#include "pcm/system/file.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

namespace pcm {
namespace {

class PlyReader final : public PointReader {
public:
    explicit PlyReader(const std::filesystem::path& path)
        : file_(path, File::Mode::read), file_size_(file_.size()), header_(read_ply_header(file_))
    {
        PlyPlan plan = plan_ply(path, header_, info_);
        vertex_element_ = plan.vertex_element;
        targets_ = std::move(plan.targets);
        record_bytes_ = plan.record_bytes;
        check_bytes_hold_the_points();
        info_.format = format_name(header_);
        for (std::string& note : other_elements(header_, vertex_element_)) info_.notes.push_back(std::move(note));
        if (addressable_) note_surplus(file_size_ - vertex_offset_ - vertices().count * vertices().least_bytes());
        beyond_.resize(info_.schema.size());
        batch_points_ = points_that_fit_a_batch(info_.schema);
    }

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return addressable_; }
    void seek(std::uint64_t index) override;
    double fraction_read() const override;

private:
    [[noreturn]] void fail(ErrorCode code, const std::string& what) const { throw Error(code, file_.path(), what); }
    [[noreturn]] void fail_line(ErrorCode code, const std::string& what) const
    {
        fail(code, "line " + std::to_string(lines_->line_number()) + ": " + what);
    }
    bool ascii() const { return header_.encoding == PlyHeader::Encoding::ascii; }
    const PlyElement& vertices() const { return header_.elements[vertex_element_]; }

    void check_bytes_hold_the_points();
    void note_surplus(std::uint64_t bytes);

    void start();
    std::uint64_t take_list_length(const PlyProperty& list, const std::string& owner);
    void read_lists_of(const PlyElement& element, std::uint64_t instance, std::byte* record);
    void read_line(std::byte* record);
    void unpack(const std::byte* records, std::size_t count, PointBatch& batch, std::size_t first);
    template <bool Swap>
    void unpack(const std::byte* records, std::size_t count, PointBatch& batch, std::size_t first);

    File file_;
    std::uint64_t file_size_;
    PlyHeader header_;
    FileInfo info_;
    std::size_t vertex_element_ = 0;
    std::vector<PlyTarget> targets_;
    std::size_t record_bytes_ = 0;
    bool addressable_ = false;         // binary, without lists in the vertices and before them
    std::uint64_t vertex_offset_ = 0;  // when addressable
    std::size_t batch_points_ = 1;
    std::vector<std::uint64_t> beyond_;  // values that are not in the range of the attribute's type

    std::uint64_t next_ = 0;
    bool started_ = false, surplus_noted_ = false;
    std::optional<ByteStream> bytes_;  // binary, not addressable
    std::optional<LineStream> lines_;  // ascii
    std::vector<std::byte> buffer_;
};

// Checks sizes as far as possible without reading lists and lines.
void PlyReader::check_bytes_hold_the_points()
{
    addressable_ = !ascii();
    std::uint64_t offset = header_.bytes;
    for (std::size_t i = 0; i <= vertex_element_; ++i) {
        const PlyElement& element = header_.elements[i];
        // In ascii a number takes a digit and a separator; the last one of the file may have none.
        const std::uint64_t least = ascii() ? 2 * element.properties.size() : element.least_bytes();
        const std::uint64_t left = file_size_ - std::min(offset, file_size_) + (ascii() ? 1 : 0);
        if (i == vertex_element_) vertex_offset_ = offset;
        if (least && element.count > left / least)
            fail(ErrorCode::truncated,
                 "the header promises " + std::to_string(element.count) + " instances of '" + element.name +
                     "' of at least " + std::to_string(least) + " bytes; from byte " + std::to_string(offset) +
                     " to the end of the file there are " + std::to_string(file_size_ - std::min(offset, file_size_)));
        offset += element.count * least;
        if (element.has_lists()) addressable_ = false;
    }
}

void PlyReader::note_surplus(std::uint64_t bytes)
{
    if (std::exchange(surplus_noted_, true)) return;
    const auto note =
        ascii() ? surplus_lines(header_, vertex_element_, *lines_) : surplus_bytes(header_, vertex_element_, bytes);
    if (note) info_.notes.push_back(*note);
}

// Skips the elements before the vertices.
void PlyReader::start()
{
    started_ = true;
    if (ascii()) {
        lines_.emplace(file_, header_.bytes, header_.lines, header_.ends_lines_with_cr ? '\r' : '\n');
        for (std::size_t e = 0; e < vertex_element_; ++e) {
            const PlyElement& element = header_.elements[e];
            std::string_view line;
            for (std::uint64_t i = 0; !element.properties.empty() && i < element.count; ++i)
                if (!lines_->next(line))
                    fail_line(ErrorCode::truncated, "the file ends after " + std::to_string(i) + " of " +
                                                        std::to_string(element.count) + " lines of '" + element.name +
                                                        "'");
        }
        return;
    }
    if (addressable_) return;
    bytes_.emplace(file_, header_.bytes, file_size_);
    for (std::size_t e = 0; e < vertex_element_; ++e) {
        const PlyElement& element = header_.elements[e];
        if (!element.has_lists())
            bytes_->skip(element.count * element.least_bytes());
        else
            for (std::uint64_t i = 0; i < element.count; ++i) read_lists_of(element, i, nullptr);
    }
}

std::uint64_t PlyReader::take_list_length(const PlyProperty& list, const std::string& owner)
{
    std::array<std::byte, 8> raw{};
    const std::uint64_t at = bytes_->position();
    bytes_->take(raw.data(), size_of(list.count_type));
    const bool swap = header_.encoding == PlyHeader::Encoding::big_endian;
    return with_type(list.count_type, [&](auto example) {
        using T = decltype(example);
        const T length = swap ? load_scalar<T, true>(raw.data()) : load_scalar<T, false>(raw.data());
        if (length < T{0})
            fail(ErrorCode::bad_format, "byte " + std::to_string(at) + ": the list '" + list.name + "' of " + owner +
                                            " has " + std::to_string(length) + " entries");
        return static_cast<std::uint64_t>(length);
    });
}

// Reads one binary instance; its scalars are stored consecutively in `record`, unless that is null.
void PlyReader::read_lists_of(const PlyElement& element, std::uint64_t instance, std::byte* record)
{
    for (const PlyProperty& property : element.properties) {
        const std::size_t bytes = size_of(property.type);
        if (property.is_list) {
            const std::uint64_t length = take_list_length(property, element.name + " " + std::to_string(instance));
            // An impossible length must not overflow to a possible one.
            bytes_->skip(length > bytes_->left() ? length : length * bytes);
        } else if (record) {
            bytes_->take(record, bytes);
            record += bytes;
        } else {
            bytes_->skip(bytes);
        }
    }
}

// Reads one ascii vertex; stores its scalars in `record` as in a little endian file.
void PlyReader::read_line(std::byte* record)
{
    std::string_view line;
    if (!lines_->next(line))
        fail_line(ErrorCode::truncated,
                  "the file ends after " + std::to_string(next_) + " of " + std::to_string(info_.points) + " vertices");
    LineWords words(line);
    std::string_view word;
    const auto ends_before = [&](const PlyProperty& property) {
        fail_line(ErrorCode::bad_format,
                  "found " + quote_bytes(line) + ", which ends before the property '" + property.name + "'");
    };
    for (const PlyProperty& property : vertices().properties) {
        if (property.is_list) {
            std::uint64_t length = 0;
            if (!words.next_number(ScalarType::u64, reinterpret_cast<std::byte*>(&length), word)) {
                if (word.empty()) ends_before(property);
                fail_line(ErrorCode::bad_format,
                          "found " + quote_bytes(word) + ", expected the length of the list '" + property.name + "'");
            }
            for (std::uint64_t i = 0; i < length; ++i)
                if (words.next().empty()) ends_before(property);
            continue;
        }
        if (!words.next_number(property.type, record, word)) {
            if (word.empty()) ends_before(property);
            fail_line(ErrorCode::bad_format, "found " + quote_bytes(word) + " for the property '" + property.name +
                                                 "', expected a number of type " + std::string(name_of(property.type)));
        }
        record += size_of(property.type);
    }
    if (const std::string_view more = words.next(); !more.empty())
        fail_line(ErrorCode::bad_format,
                  "found " + quote_bytes(more) + " after the last property, expected the end of the line");
}

template <bool Swap>
void PlyReader::unpack(const std::byte* records, std::size_t count, PointBatch& batch, std::size_t first)
{
    for (const PlyTarget& target : targets_) {
        if (target.kind == PlyTarget::Kind::skipped) continue;
        const std::byte* from = records + target.offset;
        if (target.kind == PlyTarget::Kind::axis) {
            double* to = batch.xyz[target.index].data() + first;
            with_type(target.type,
                      [&](auto example) { widen<decltype(example), Swap>(from, record_bytes_, count, to); });
            continue;
        }
        Column& column = batch.attributes[target.index];
        const std::size_t stride = column.point_bytes();
        std::byte* to = column.data() + first * stride + target.byte;
        if (target.kind == PlyTarget::Kind::restored)
            beyond_[target.index] += restore_values(info_.schema[target.index], target.type, target.step, Swap, from,
                                                    record_bytes_, count, to, stride);
        else
            copy_scalars<Swap>(size_of(target.type), from, record_bytes_, count, to, stride);
    }
}

void PlyReader::unpack(const std::byte* records, std::size_t count, PointBatch& batch, std::size_t first)
{
    if (header_.encoding == PlyHeader::Encoding::big_endian)
        unpack<true>(records, count, batch, first);
    else
        unpack<false>(records, count, batch, first);
}

bool PlyReader::read(PointBatch& batch, std::size_t max_points)
{
    if (!started_) start();
    const auto count = static_cast<std::size_t>(
        std::min<std::uint64_t>(info_.points - next_, std::min(std::max<std::size_t>(max_points, 1), batch_points_)));
    shape_batch(batch, info_.schema, false, count);
    if (count == 0) {
        note_surplus(bytes_ ? bytes_->left() : 0);
        return false;
    }

    // Small enough to stay in the cache while its fields are decoded, unless it must be read from the file.
    const std::size_t buffer_bytes = std::size_t{1} << (addressable_ ? 18 : 14);
    const std::size_t buffer_points = std::max<std::size_t>(1, buffer_bytes / record_bytes_);
    buffer_.resize(buffer_points * record_bytes_);
    for (std::size_t done = 0; done < count;) {
        const std::size_t now = std::min(buffer_points, count - done);
        if (addressable_) {
            file_.read_at(buffer_.data(), now * record_bytes_, vertex_offset_ + next_ * record_bytes_);
            next_ += now;
        } else {
            for (std::size_t i = 0; i < now; ++i, ++next_) {
                std::byte* record = buffer_.data() + i * record_bytes_;
                if (ascii())
                    read_line(record);
                else
                    read_lists_of(vertices(), next_, record);
            }
        }
        unpack(buffer_.data(), now, batch, done);
        done += now;
    }
    if (next_ == info_.points) note_values_beyond(info_.schema, beyond_, info_.notes);
    return true;
}

void PlyReader::seek(std::uint64_t index)
{
    if (!addressable_) return PointReader::seek(index);
    if (index > info_.points)
        fail(ErrorCode::invalid_argument,
             "point " + std::to_string(index) + " was requested, the file has " + std::to_string(info_.points));
    next_ = index;
}

double PlyReader::fraction_read() const
{
    if (next_ == info_.points) return 1.0;
    if (addressable_) return static_cast<double>(next_) / static_cast<double>(info_.points);
    const std::uint64_t consumed = lines_ ? lines_->bytes_consumed() : bytes_ ? bytes_->position() : 0;
    return file_size_ ? static_cast<double>(consumed) / static_cast<double>(file_size_) : 1.0;
}

}  // namespace

std::unique_ptr<PointReader> open_ply(const std::filesystem::path& path, const ReadOptions&)
{
    return std::make_unique<PlyReader>(path);
}

bool ply_only_points(const std::filesystem::path& path)
{
    const PlyHeader header = read_ply_header(File(path, File::Mode::read));
    return std::all_of(header.elements.begin(), header.elements.end(),
                       [](const PlyElement& element) { return element.name == "vertex" || element.count == 0; });
}

}  // namespace pcm
