#include "pcm/io/pcd/pcd_reader.h"

#include "pcm/io/file_text.h"
#include "pcm/io/pcd/lzf_stream.h"
#include "pcm/io/pcd/pcd_header.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/records/carried_comments.h"
#include "pcm/io/records/line_stream.h"
#include "pcm/io/records/line_words.h"
#include "pcm/io/records/scalars.h"
#include "pcm/io/unique_name.h"
#include "pcm/system/file.h"

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
constexpr auto no_field = static_cast<std::size_t>(-1);

// The destination of a field.
struct Target {
    enum class Kind { none, axis, scalars, packed_colour } kind = Kind::none;
    std::size_t index = 0;             // the axis or the attribute
    std::size_t byte = 0;              // first byte among the attribute's bytes of a point
    std::optional<std::size_t> alpha;  // packed_colour: this attribute's
    ScalarType type = ScalarType::f32;
    std::size_t bytes = 0;   // of a point
    std::size_t offset = 0;  // in a record
};

// Copies `count` values of a field, `stride` bytes apart, to columns of the batch from point `first` on.
void unpack(const Target& target, const std::byte* from, std::size_t stride, std::size_t count, PointBatch& batch,
            std::size_t first)
{
    if (target.kind == Target::Kind::axis) {
        double* const to = batch.xyz[target.index].data() + first;
        with_type(target.type, [&](auto example) { widen<decltype(example)>(from, stride, count, to); });
        return;
    }
    Column& column = batch.attributes[target.index];
    const std::size_t to_stride = column.point_bytes();
    std::byte* to = column.data() + first * to_stride + target.byte;
    if (target.kind == Target::Kind::packed_colour) {
        for (std::size_t i = 0; i < count; ++i, to += 3) {
            const auto colour = load_scalar<std::uint32_t>(from + i * stride);
            for (std::size_t c = 0; c < 3; ++c) to[c] = static_cast<std::byte>(colour >> (16 - 8 * c) & 255u);
            if (target.alpha)
                batch.attributes[*target.alpha].as<std::uint8_t>()[first + i] = static_cast<std::uint8_t>(colour >> 24);
        }
        return;
    }
    copy_scalars(target.bytes, from, stride, count, to, to_stride);
}

class PcdReader final : public PointReader {
public:
    explicit PcdReader(const std::filesystem::path& path)
        : file_(path, File::Mode::read), file_size_(file_.size()), header_(read_pcd_header(file_))
    {
        info_.notes = header_.notes;
        info_.points = header_.points;
        plan();
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

    void plan();
    void plan_axes();
    void plan_group(const std::array<const char*, 3>& members, std::string_view name);
    void plan_field(std::size_t field);
    std::size_t add_attribute(Attribute attribute);
    void restore(const CarriedAttribute& carried);
    void check_bytes_hold_the_points();
    void check_compressed();
    void describe();

    void start();
    void read_records(PointBatch& batch, std::size_t count);
    void read_columns(PointBatch& batch, std::size_t count);
    void note_rest();
    void read_line(std::byte* record);
    std::uint32_t colour_of(LineWords& words, const PcdField& field, std::string_view& word) const;

    File file_;
    std::uint64_t file_size_;
    PcdHeader header_;
    FileInfo info_;
    std::vector<Target> targets_;  // one per field
    std::size_t record_bytes_ = 0;
    std::size_t batch_points_ = 1;
    std::uint64_t compressed_bytes_ = 0;
    bool padding_compressed_ = false;  // whether the compressed block has columns for "_"

    std::uint64_t next_ = 0;
    bool started_ = false;
    std::optional<LineStream> lines_;
    std::vector<LzfStream> columns_;  // of the fields with a target
    std::vector<std::byte> buffer_;
};

std::size_t PcdReader::add_attribute(Attribute attribute)
{
    if (info_.schema.size() == max_attributes)
        fail(ErrorCode::unsupported, "a point has more than " + std::to_string(max_attributes) + " attributes");
    attribute.name = unique_name(info_.schema, attribute.name);
    info_.schema.add(std::move(attribute));
    return info_.schema.size() - 1;
}

void PcdReader::plan_axes()
{
    std::array<bool, 3> have{};
    bool all_f32 = true;
    for (std::size_t i = 0; i < header_.fields.size(); ++i) {
        const PcdField& field = header_.fields[i];
        const std::string name = lower_case(field.name);
        if (name.size() != 1 || name[0] < 'x' || name[0] > 'z') continue;
        const auto axis = static_cast<std::size_t>(name[0] - 'x');
        if (std::exchange(have[axis], true)) fail(ErrorCode::bad_format, "the header has two fields '" + name + "'");
        if (field.count != 1)
            fail(ErrorCode::bad_format,
                 "the field '" + name + "' has COUNT " + std::to_string(field.count) + ", expected 1");
        targets_[i].kind = Target::Kind::axis;
        targets_[i].index = axis;
        all_f32 = all_f32 && field.type == ScalarType::f32;
    }
    for (std::size_t a = 0; a < 3; ++a)
        if (!have[a]) fail(ErrorCode::bad_format, "the header has no field '" + std::string(1, "xyz"[a]) + "'");
    info_.position_type = all_f32 ? ScalarType::f32 : ScalarType::f64;
}

// Joins the three fields to one attribute if each exists once, with COUNT 1, and all have the same type.
void PcdReader::plan_group(const std::array<const char*, 3>& members, std::string_view name)
{
    if (info_.schema.find(name)) return;
    const std::vector<PcdField>& fields = header_.fields;
    std::array<std::size_t, 3> at{no_field, no_field, no_field};
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < fields.size(); ++i) {
            if (lower_case(fields[i].name) != members[c]) continue;
            if (at[c] != no_field || fields[i].count != 1) return;
            at[c] = i;
        }
    for (const std::size_t i : at)
        if (i == no_field || fields[i].type != fields[at[0]].type || targets_[i].kind != Target::Kind::none) return;
    const ScalarType type = fields[at[0]].type;
    const std::size_t attribute = add_attribute({std::string(name), type, 3, 1, 0, {}});
    for (std::size_t c = 0; c < 3; ++c) {
        targets_[at[c]].kind = Target::Kind::scalars;
        targets_[at[c]].index = attribute;
        targets_[at[c]].byte = c * size_of(type);
    }
}

void PcdReader::plan_field(std::size_t i)
{
    const PcdField& field = header_.fields[i];
    Target& target = targets_[i];
    const std::string name = lower_case(field.name);
    if ((name == "rgb" || name == "rgba") && field.count == 1 && size_of(field.type) == 4 &&
        !info_.schema.find(attribute_name::rgb)) {
        target.kind = Target::Kind::packed_colour;
        target.index = add_attribute({std::string(attribute_name::rgb), ScalarType::u8, 3, 1, 0, {}});
        if (name == "rgba") target.alpha = add_attribute({"alpha", ScalarType::u8, 1, 1, 0, {}});
        return;
    }
    std::string attribute = pcd_attribute_name(field.name);
    if ((attribute == attribute_name::rgb || attribute == attribute_name::normal) && field.count != 3)
        attribute += "_scalar";  // these names mean three components
    target.kind = Target::Kind::scalars;
    target.index = add_attribute({attribute, field.type, field.count, 1, 0, {}});
}

// Applies a comment about an attribute, if the fields agree with it.
void PcdReader::restore(const CarriedAttribute& carried)
{
    const Attribute& attribute = carried.attribute;
    std::optional<std::size_t> index;
    for (std::size_t i = 0; i < targets_.size(); ++i)
        if (header_.fields[i].name == carried.field &&
            (targets_[i].kind == Target::Kind::scalars || targets_[i].kind == Target::Kind::packed_colour))
            index = targets_[i].index;
    const bool means_three = attribute.name == attribute_name::rgb || attribute.name == attribute_name::normal;
    if (!index || info_.schema[*index].type != attribute.type ||
        info_.schema[*index].components != attribute.components || (means_three && attribute.components != 3)) {
        info_.notes.push_back("a comment about the attribute '" + attribute.name +
                              "' is ignored: no field agrees with it");
        return;
    }
    Schema schema;
    for (std::size_t i = 0; i < info_.schema.size(); ++i) {
        if (i != *index) {
            Attribute other = info_.schema[i];
            if (other.name == attribute.name) other.name = unique_name(info_.schema, other.name);
            schema.add(std::move(other));
        } else {
            schema.add(attribute);
        }
    }
    info_.schema = std::move(schema);
}

void PcdReader::plan()
{
    const std::vector<PcdField>& fields = header_.fields;
    targets_.assign(fields.size(), {});
    std::size_t offset = 0;
    for (std::size_t i = 0; i < fields.size(); ++i) {
        targets_[i].type = fields[i].type;
        targets_[i].bytes = static_cast<std::size_t>(fields[i].bytes());
        targets_[i].offset = offset;
        offset += targets_[i].bytes;
    }
    record_bytes_ = offset;
    plan_axes();

    using Names = std::array<const char*, 3>;
    const auto begins = [&](std::size_t field, const Names& members) {
        const std::string name = lower_case(fields[field].name);
        return std::find(members.begin(), members.end(), name) != members.end();
    };
    // In the order of the fields, so that attributes come in the order of the file.
    for (std::size_t i = 0; i < fields.size(); ++i) {
        for (const Names& members : {Names{"red", "green", "blue"}, Names{"r", "g", "b"}})
            if (targets_[i].kind == Target::Kind::none && begins(i, members)) plan_group(members, attribute_name::rgb);
        for (const Names& members : {Names{"normal_x", "normal_y", "normal_z"}, Names{"nx", "ny", "nz"}})
            if (targets_[i].kind == Target::Kind::none && begins(i, members))
                plan_group(members, attribute_name::normal);
        if (targets_[i].kind == Target::Kind::none && !fields[i].is_padding()) plan_field(i);
    }
    const Carried carried = read_carried_comments(header_.comments, info_.notes);
    info_.metadata = carried.metadata;
    for (const CarriedAttribute& attribute : carried.attributes) restore(attribute);
}

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
    if (padding_compressed_ && !is(record_bytes_))
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
    const std::uint64_t least = ascii ? 2 * header_.numbers() : record_bytes_;
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
    if (header_.viewpoint.empty()) return;
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
    for (std::size_t i = 0; i < targets_.size(); ++i) {
        if (targets_[i].kind != Target::Kind::none) columns_.push_back(stream);
        if (padding_compressed_ || !header_.fields[i].is_padding())
            stream.take(nullptr, header_.points * targets_[i].bytes);
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
    for (std::size_t i = 0; i < targets_.size(); ++i) {
        const PcdField& field = header_.fields[i];
        const Target& target = targets_[i];
        std::byte* to = record + target.offset;
        if (words.at_end() && field.count)
            fail_line(ErrorCode::bad_format,
                      "found " + quote_bytes(line) + ", which ends before the field '" + field.name + "'");
        if (target.kind == Target::Kind::packed_colour) {
            const std::uint32_t colour = colour_of(words, field, word);
            std::memcpy(to, &colour, sizeof colour);
            continue;
        }
        for (std::uint32_t k = 0; k < field.count; ++k, to += size_of(field.type)) {
            const bool found = target.kind == Target::Kind::none ? !(word = words.next()).empty()
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
    const std::size_t tile = std::max<std::size_t>(1, (ascii ? tile_bytes / 16 : tile_bytes) / record_bytes_);
    buffer_.resize(std::min(tile, count) * record_bytes_);
    for (std::size_t done = 0; done < count;) {
        const std::size_t now = std::min(tile, count - done);
        if (ascii) {
            for (std::size_t i = 0; i < now; ++i, ++next_) read_line(buffer_.data() + i * record_bytes_);
        } else {
            file_.read_at(buffer_.data(), now * record_bytes_, header_.bytes + next_ * record_bytes_);
            next_ += now;
        }
        for (const Target& target : targets_)
            if (target.kind != Target::Kind::none)
                unpack(target, buffer_.data() + target.offset, record_bytes_, now, batch, done);
        done += now;
    }
}

void PcdReader::read_columns(PointBatch& batch, std::size_t count)
{
    auto column = columns_.begin();
    for (const Target& target : targets_) {
        if (target.kind == Target::Kind::none) continue;
        const std::size_t tile = std::max<std::size_t>(1, tile_bytes / 16 / target.bytes);
        buffer_.resize(std::min(tile, count) * target.bytes);
        for (std::size_t done = 0; done < count;) {
            const std::size_t now = std::min(tile, count - done);
            column->take(buffer_.data(), now * target.bytes);
            unpack(target, buffer_.data(), target.bytes, now, batch, done);
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
        info_.notes.push_back(*rest + "; the header promises " + std::to_string(info_.points) + " points");
}

bool PcdReader::read(PointBatch& batch, std::size_t max_points)
{
    if (!started_) start();
    const auto count = static_cast<std::size_t>(
        std::min<std::uint64_t>(info_.points - next_, std::min(std::max<std::size_t>(max_points, 1), batch_points_)));
    shape_batch(batch, info_.schema, false, count);
    if (count == 0 && lines_) note_rest();  // of a file that promises no points
    if (count == 0) return false;
    if (header_.encoding == PcdHeader::Encoding::compressed)
        read_columns(batch, count);
    else
        read_records(batch, count);
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
