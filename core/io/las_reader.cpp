#include "io/las_reader.h"

#include "cloud/file.h"
#include "io/batch_shape.h"
#include "io/las_layout.h"
#include "io/names.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

namespace pcm {
namespace {

namespace at = las::header;

constexpr std::size_t read_buffer_bytes = std::size_t{1} << 20;
// Records taken apart at a time, field by field: they stay in the first-level cache between the fields.
constexpr std::size_t block_bytes = 16384;
// Metadata travels in memory; waveforms, which can be many gigabytes in one EVLR, do not.
constexpr std::uint64_t max_metadata_bytes = std::uint64_t{64} << 20;
constexpr std::size_t max_notes = 100;

constexpr std::size_t vlr_header_bytes = 54;
constexpr std::size_t evlr_header_bytes = 60;
constexpr std::size_t extra_descriptor_bytes = 192;
constexpr std::string_view spec_user_id = "LASF_Spec";
constexpr std::uint16_t extra_bytes_record_id = 4;

// Where an attribute lies in a record: whole bytes, or some bits of one byte.
struct Field {
    std::size_t offset = 0;
    std::size_t bytes = 0;  // of all components
    unsigned shift = 0;
    unsigned mask = 0;  // not 0: one byte, (byte >> shift) & mask
};

template <std::size_t Bytes>
void copy_strided(const std::byte* from, std::size_t stride, std::size_t count, std::byte* to)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * Bytes, from + i * stride, Bytes);
}

void copy_field(const Field& field, const std::byte* records, std::size_t stride, std::size_t count, std::byte* to)
{
    const std::byte* from = records + field.offset;
    if (field.mask) {
        for (std::size_t i = 0; i < count; ++i)
            to[i] = (from[i * stride] >> field.shift) & static_cast<std::byte>(field.mask);
        return;
    }
    switch (field.bytes) {
        case 1:
            return copy_strided<1>(from, stride, count, to);
        case 2:
            return copy_strided<2>(from, stride, count, to);
        case 4:
            return copy_strided<4>(from, stride, count, to);
        case 6:
            return copy_strided<6>(from, stride, count, to);
        case 8:
            return copy_strided<8>(from, stride, count, to);
        case 12:
            return copy_strided<12>(from, stride, count, to);
        default:
            for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * field.bytes, from + i * stride, field.bytes);
    }
}

struct Record {  // a VLR or EVLR that could be kept
    std::string user_id;
    std::uint16_t id = 0;
    std::vector<std::byte> value;
};

class LasReader final : public PointReader {
public:
    explicit LasReader(const std::filesystem::path& path) : file_(path, File::Mode::read), file_size_(file_.size())
    {
        read_header();
        const std::vector<Record> vlrs = read_vlrs();
        const std::vector<Record> evlrs = read_evlrs();
        plan_fields();
        plan_extra_bytes(vlrs, evlrs);
        batch_points_ = points_that_fit_a_batch(info_.schema);
    }

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return true; }
    void seek(std::uint64_t index) override;
    double fraction_read() const override
    {
        return info_.points ? static_cast<double>(next_) / static_cast<double>(info_.points) : 1.0;
    }

private:
    [[noreturn]] void fail(ErrorCode code, const std::string& what, const std::string& hint = {}) const
    {
        throw Error(code, file_.path(), what, hint);
    }
    void note(std::string text)
    {
        if (info_.notes.size() < max_notes) info_.notes.push_back(std::move(text));
    }

    void read_header();
    void read_grid(const std::byte* header);
    void check_bytes_hold_the_points();
    std::vector<Record> read_vlrs();
    std::vector<Record> read_evlrs();
    bool keep(const std::string& prefix, Record& record, std::uint64_t offset, std::uint64_t length);

    void add(std::string name, ScalarType type, std::uint32_t components, std::size_t offset, double scale = 1.0);
    void add_bits(std::string name, std::size_t offset, unsigned shift, unsigned mask);
    void plan_fields();
    void plan_wave_packet(std::size_t offset);
    void plan_extra_bytes(const std::vector<Record>& vlrs, const std::vector<Record>& evlrs);
    bool plan_described(const std::vector<std::byte>& descriptors, std::size_t extra);
    void plan_raw(std::size_t offset, std::size_t count);

    File file_;
    std::uint64_t file_size_ = 0;
    FileInfo info_;
    unsigned version_minor_ = 0;
    unsigned format_ = 0;
    std::size_t header_size_ = 0;
    std::uint64_t point_offset_ = 0;
    std::size_t record_length_ = 0;
    std::uint64_t vlr_count_ = 0;
    std::uint64_t evlr_start_ = 0;
    std::uint64_t evlr_count_ = 0;
    std::uint64_t metadata_bytes_ = 0;

    std::vector<Field> fields_;  // one for each attribute of the schema
    std::size_t batch_points_ = 1;
    std::uint64_t next_ = 0;
    std::vector<std::byte> buffer_;
};

void LasReader::read_header()
{
    std::array<std::byte, at::size_1_4> bytes{};
    const std::size_t got = file_.read_some_at(bytes.data(), bytes.size(), 0);
    if (got < 4 || std::memcmp(bytes.data(), "LASF", 4) != 0)
        fail(ErrorCode::bad_format, "not a LAS file: it does not begin with 'LASF'");
    if (got < at::size_1_0)
        fail(ErrorCode::truncated,
             "the file ends at byte " + std::to_string(got) + " within the LAS header, which has at least 227 bytes");

    const auto version_major = las::load<std::uint8_t>(&bytes[at::version_major]);
    version_minor_ = las::load<std::uint8_t>(&bytes[at::version_minor]);
    if (version_major != 1 || version_minor_ > 4)
        fail(ErrorCode::unsupported, "LAS version " + std::to_string(version_major) + "." +
                                         std::to_string(version_minor_) + " found; 1.0 to 1.4 can be read");
    const std::string version = "LAS 1." + std::to_string(version_minor_);

    const auto format_byte = las::load<std::uint8_t>(&bytes[at::point_format]);
    if (format_byte & 0xC0u)
        fail(ErrorCode::unsupported,
             "this is LAZ (compressed " + version + ", point format " + std::to_string(format_byte & 0x3Fu) +
                 "); only uncompressed LAS can be read",
             "convert it to LAS first, for example with laszip or PDAL");
    format_ = format_byte;
    if (format_ >= las::record_bytes.size())
        fail(ErrorCode::unsupported, "LAS point format " + std::to_string(format_) + " found; 0 to 10 can be read");
    info_.format = version + ", point format " + std::to_string(format_);

    header_size_ = las::load<std::uint16_t>(&bytes[at::header_size]);
    const std::size_t least_header = version_minor_ >= 4 ? at::size_1_4 : at::size_1_0;
    if (header_size_ < least_header)
        fail(ErrorCode::bad_format, "the header says it has " + std::to_string(header_size_) + " bytes; " + version +
                                        " has at least " + std::to_string(least_header));
    if (header_size_ > file_size_ || (version_minor_ >= 4 && got < at::size_1_4))
        fail(ErrorCode::truncated,
             "the header has " + std::to_string(header_size_) + " bytes, the file only " + std::to_string(file_size_));

    point_offset_ = las::load<std::uint32_t>(&bytes[at::point_offset]);
    if (point_offset_ < header_size_)
        fail(ErrorCode::bad_format, "the points are said to begin at byte " + std::to_string(point_offset_) +
                                        ", inside the header of " + std::to_string(header_size_) + " bytes");
    if (point_offset_ > file_size_)
        fail(ErrorCode::truncated, "the points are said to begin at byte " + std::to_string(point_offset_) +
                                       ", the file ends at byte " + std::to_string(file_size_));

    record_length_ = las::load<std::uint16_t>(&bytes[at::record_length]);
    if (record_length_ < las::record_bytes[format_])
        fail(ErrorCode::bad_format, "the header says " + std::to_string(record_length_) +
                                        " bytes a point; point format " + std::to_string(format_) + " has at least " +
                                        std::to_string(las::record_bytes[format_]));
    const unsigned format_since = format_ >= 6 ? 4 : format_ >= 4 ? 3 : format_ >= 2 ? 2 : 0;
    if (version_minor_ < format_since)
        note("point format " + std::to_string(format_) + " is not part of " + version + "; read as in LAS 1." +
             std::to_string(format_since));

    vlr_count_ = las::load<std::uint32_t>(&bytes[at::vlr_count]);
    info_.points = las::load<std::uint32_t>(&bytes[at::point_count_32]);
    if (version_minor_ >= 4) {
        const auto count = las::load<std::uint64_t>(&bytes[at::point_count_64]);
        if (count && info_.points && count != info_.points)
            note("the header has two point counts, " + std::to_string(info_.points) + " and " + std::to_string(count) +
                 "; the second, of LAS 1.4, is taken");
        if (count) info_.points = count;
        evlr_start_ = las::load<std::uint64_t>(&bytes[at::evlr_start]);
        evlr_count_ = las::load<std::uint32_t>(&bytes[at::evlr_count]);
    }
    check_bytes_hold_the_points();
    read_grid(bytes.data());
}

void LasReader::check_bytes_hold_the_points()
{
    const std::uint64_t available = file_size_ - point_offset_;
    const std::uint64_t complete = available / record_length_;
    if (info_.points > complete)
        fail(ErrorCode::truncated, "the header promises " + std::to_string(info_.points) + " points of " +
                                       std::to_string(record_length_) + " bytes from byte " +
                                       std::to_string(point_offset_) + "; the file ends at byte " +
                                       std::to_string(file_size_) + " and holds " + std::to_string(complete));
    // Since 1.3 waveforms and EVLRs may follow the points.
    const std::uint64_t left = available - info_.points * record_length_;
    if (left && version_minor_ < 3) note(std::to_string(left) + " bytes after the last point are ignored");
}

void LasReader::read_grid(const std::byte* header)
{
    Grid grid;
    Box3d box;
    bool box_is_finite = true;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::string axis(1, "xyz"[a]);
        grid.scale[a] = las::load<double>(header + at::scale + 8 * a);
        grid.offset[a] = las::load<double>(header + at::offset + 8 * a);
        if (!(grid.scale[a] > 0) || !std::isfinite(grid.scale[a]))
            fail(ErrorCode::bad_format,
                 "the scale of " + axis + " is " + std::to_string(grid.scale[a]) + "; a positive number was expected");
        if (!std::isfinite(grid.offset[a]))
            fail(ErrorCode::bad_format,
                 "the offset of " + axis + " is " + std::to_string(grid.offset[a]) + "; a finite number was expected");
        box.max[a] = las::load<double>(header + at::box + 16 * a);
        box.min[a] = las::load<double>(header + at::box + 16 * a + 8);
        box_is_finite = box_is_finite && std::isfinite(box.min[a]) && std::isfinite(box.max[a]);
    }
    info_.position_type = ScalarType::i32;
    info_.grid = grid;
    if (info_.points && box_is_finite && !box.empty()) info_.promised_box = box;
}

// Fills record.value and copies it to the metadata; false when it is too much to carry in memory.
bool LasReader::keep(const std::string& prefix, Record& record, std::uint64_t offset, std::uint64_t length)
{
    const std::string key = prefix + record.user_id + "/" + std::to_string(record.id);
    constexpr std::uint64_t overhead =
        128;  // of an entry: a file of nothing but empty records must not fill the memory
    if (max_metadata_bytes - metadata_bytes_ < overhead || length > max_metadata_bytes - metadata_bytes_ - overhead) {
        note(key + " of " + std::to_string(length) + " bytes is not kept: metadata are limited to " +
             std::to_string(max_metadata_bytes) + " bytes");
        return false;
    }
    metadata_bytes_ += length + overhead;
    record.value.resize(static_cast<std::size_t>(length));
    file_.read_at(record.value.data(), record.value.size(), offset);
    info_.metadata.push_back({key, record.value});
    return true;
}

std::vector<Record> LasReader::read_vlrs()
{
    std::vector<Record> records;
    std::uint64_t position = header_size_;
    for (std::uint64_t i = 0; i < vlr_count_; ++i) {
        const auto give_up = [&] {
            note("VLR " + std::to_string(i + 1) + " of " + std::to_string(vlr_count_) + " at byte " +
                 std::to_string(position) + " runs over the start of the points at byte " +
                 std::to_string(point_offset_) + "; it and the rest are ignored");
        };
        if (point_offset_ - position < vlr_header_bytes) {
            give_up();
            break;
        }
        std::array<std::byte, vlr_header_bytes> head;
        file_.read_at(head.data(), head.size(), position);
        Record record;
        record.user_id = printable_name({reinterpret_cast<const char*>(&head[2]), 16});
        record.id = las::load<std::uint16_t>(&head[18]);
        const std::uint64_t length = las::load<std::uint16_t>(&head[20]);
        if (point_offset_ - position - vlr_header_bytes < length) {
            give_up();
            break;
        }
        if (keep("las.vlr/", record, position + vlr_header_bytes, length)) records.push_back(std::move(record));
        position += vlr_header_bytes + length;
    }
    return records;
}

std::vector<Record> LasReader::read_evlrs()
{
    std::vector<Record> records;
    const std::uint64_t points_end = point_offset_ + info_.points * record_length_;
    if (evlr_count_ && evlr_start_ < points_end) {
        note("the extended VLRs are said to begin at byte " + std::to_string(evlr_start_) +
             ", before the end of the points at byte " + std::to_string(points_end) + "; they are ignored");
        return records;
    }
    std::uint64_t position = evlr_start_;
    for (std::uint64_t i = 0; i < evlr_count_; ++i) {
        const auto give_up = [&] {
            note("extended VLR " + std::to_string(i + 1) + " of " + std::to_string(evlr_count_) + " at byte " +
                 std::to_string(position) + " runs over the end of the file at byte " + std::to_string(file_size_) +
                 "; it and the rest are ignored");
        };
        if (position > file_size_ || file_size_ - position < evlr_header_bytes) {
            give_up();
            break;
        }
        std::array<std::byte, evlr_header_bytes> head;
        file_.read_at(head.data(), head.size(), position);
        Record record;
        record.user_id = printable_name({reinterpret_cast<const char*>(&head[2]), 16});
        record.id = las::load<std::uint16_t>(&head[18]);
        const auto length = las::load<std::uint64_t>(&head[20]);
        if (file_size_ - position - evlr_header_bytes < length) {
            give_up();
            break;
        }
        if (keep("las.evlr/", record, position + evlr_header_bytes, length)) records.push_back(std::move(record));
        position += evlr_header_bytes + length;
    }
    return records;
}

void LasReader::add(std::string name, ScalarType type, std::uint32_t components, std::size_t offset, double scale)
{
    Attribute attribute{std::move(name), type, components, scale, 0.0, {}};
    fields_.push_back({offset, attribute.bytes(), 0, 0});
    info_.schema.add(std::move(attribute));
}

void LasReader::add_bits(std::string name, std::size_t offset, unsigned shift, unsigned mask)
{
    add(std::move(name), ScalarType::u8, 1, offset);
    fields_.back().shift = shift;
    fields_.back().mask = mask;
}

void LasReader::plan_fields()
{
    add("intensity", ScalarType::u16, 1, 12);
    if (format_ <= 5) {
        add_bits("return_number", 14, 0, 7);
        add_bits("number_of_returns", 14, 3, 7);
        add_bits("scan_direction_flag", 14, 6, 1);
        add_bits("edge_of_flight_line", 14, 7, 1);
        add_bits("classification", 15, 0, 31);
        add_bits("synthetic", 15, 5, 1);
        add_bits("key_point", 15, 6, 1);
        add_bits("withheld", 15, 7, 1);
        add("scan_angle_rank", ScalarType::i8, 1, 16);
        add("user_data", ScalarType::u8, 1, 17);
        add("point_source_id", ScalarType::u16, 1, 18);
        std::size_t next = 20;
        if (format_ != 0 && format_ != 2) {
            add("gps_time", ScalarType::f64, 1, next);
            next += 8;
        }
        if (format_ == 2 || format_ == 3 || format_ == 5) {
            add("rgb", ScalarType::u16, 3, next);
            next += 6;
        }
        if (format_ >= 4) plan_wave_packet(next);
        return;
    }
    add_bits("return_number", 14, 0, 15);
    add_bits("number_of_returns", 14, 4, 15);
    add_bits("synthetic", 15, 0, 1);
    add_bits("key_point", 15, 1, 1);
    add_bits("withheld", 15, 2, 1);
    add_bits("overlap", 15, 3, 1);
    add_bits("scanner_channel", 15, 4, 3);
    add_bits("scan_direction_flag", 15, 6, 1);
    add_bits("edge_of_flight_line", 15, 7, 1);
    add("classification", ScalarType::u8, 1, 16);
    add("user_data", ScalarType::u8, 1, 17);
    add("scan_angle", ScalarType::i16, 1, 18, 0.006);
    add("point_source_id", ScalarType::u16, 1, 20);
    add("gps_time", ScalarType::f64, 1, 22);
    std::size_t next = 30;
    if (format_ == 7 || format_ == 8 || format_ == 10) {
        add("rgb", ScalarType::u16, 3, next);
        next += 6;
    }
    if (format_ == 8 || format_ == 10) {
        add("nir", ScalarType::u16, 1, next);
        next += 2;
    }
    if (format_ >= 9) plan_wave_packet(next);
}

void LasReader::plan_wave_packet(std::size_t offset)
{
    add("wave_packet_descriptor", ScalarType::u8, 1, offset);
    add("wave_packet_offset", ScalarType::u64, 1, offset + 1);
    add("wave_packet_size", ScalarType::u32, 1, offset + 9);
    add("wave_return_location", ScalarType::f32, 1, offset + 13);
    add("wave_direction", ScalarType::f32, 3, offset + 17);
}

void LasReader::plan_extra_bytes(const std::vector<Record>& vlrs, const std::vector<Record>& evlrs)
{
    const std::size_t base = las::record_bytes[format_];
    const std::size_t extra = record_length_ - base;
    const Record* description = nullptr;
    for (const std::vector<Record>* list : {&vlrs, &evlrs})
        for (const Record& record : *list)
            if (!description && record.user_id == spec_user_id && record.id == extra_bytes_record_id)
                description = &record;

    if (description && plan_described(description->value, extra)) return;
    if (extra) plan_raw(base, extra);
}

void LasReader::plan_raw(std::size_t offset, std::size_t count)
{
    add(unique_name(info_.schema, "extra_bytes"), ScalarType::u8, static_cast<std::uint32_t>(count), offset);
}

// Turns the Extra Bytes VLR into attributes; false, with the schema as it was, when it does not fit the records.
bool LasReader::plan_described(const std::vector<std::byte>& descriptors, std::size_t extra)
{
    static constexpr ScalarType types[] = {ScalarType::u8,  ScalarType::i8,  ScalarType::u16, ScalarType::i16,
                                           ScalarType::u32, ScalarType::i32, ScalarType::u64, ScalarType::i64,
                                           ScalarType::f32, ScalarType::f64};
    constexpr unsigned has_scale = 0x08, has_offset = 0x10;
    const std::size_t base = las::record_bytes[format_];
    const Schema schema_before = info_.schema;
    const std::vector<Field> fields_before = fields_;
    const auto refuse = [&](const std::string& why) {
        info_.schema = schema_before;
        fields_ = fields_before;
        note("the Extra Bytes VLR is malformed (" + why + ")" +
             (extra ? "; the " + std::to_string(extra) + " extra bytes of a point are kept as 'extra_bytes'"
                    : "; the points have no extra bytes"));
        return false;
    };
    if (descriptors.size() % extra_descriptor_bytes != 0)
        return refuse(std::to_string(descriptors.size()) + " bytes, a multiple of 192 was expected");

    std::size_t used = 0;
    for (std::size_t start = 0; start < descriptors.size(); start += extra_descriptor_bytes) {
        const std::byte* d = descriptors.data() + start;
        const auto data_type = las::load<std::uint8_t>(d + 2);
        const auto options = las::load<std::uint8_t>(d + 3);
        if (data_type > 30) return refuse("data type " + std::to_string(data_type) + ", 0 to 30 are defined");
        // The names of LAS 1.4: 1..10 scalars, 11..20 pairs and 21..30 triples of them (deprecated), 0 plain bytes.
        const ScalarType type = data_type ? types[(data_type - 1) % 10] : ScalarType::u8;
        const std::uint32_t components = data_type ? (data_type - 1u) / 10 + 1 : options;
        const std::size_t bytes = size_of(type) * components;
        if (bytes == 0) continue;
        if (bytes > extra - used)
            return refuse("it describes more than the " + std::to_string(extra) + " bytes that a point has");

        std::string name = printable_name({reinterpret_cast<const char*>(d + 4), 32});
        if (name.empty()) name = "extra_bytes";
        const std::string description = printable_name({reinterpret_cast<const char*>(d + 160), 32});
        std::array<double, 3> scale{1, 1, 1}, offset{0, 0, 0};
        for (std::size_t c = 0; data_type && c < components; ++c) {
            if (options & has_scale) scale[c] = las::load<double>(d + 112 + 8 * c);
            if (options & has_offset) offset[c] = las::load<double>(d + 136 + 8 * c);
            if (!std::isfinite(scale[c]) || scale[c] == 0 || !std::isfinite(offset[c])) {
                note("the scale or offset of the extra bytes '" + name + "' is not a number to compute with; ignored");
                scale[c] = 1;
                offset[c] = 0;
            }
        }
        // An attribute has one scale and offset for all of its components.
        bool alike = true;
        for (std::size_t c = 1; data_type && c < components; ++c)
            alike = alike && scale[c] == scale[0] && offset[c] == offset[0];
        const std::size_t pieces = alike ? 1 : components;
        if (info_.schema.size() + pieces >= max_attributes) return refuse("more attributes than can be kept");
        for (std::size_t piece = 0; piece < pieces; ++piece) {
            Attribute attribute;
            attribute.name = unique_name(info_.schema, alike ? name : name + "[" + std::to_string(piece) + "]");
            attribute.type = type;
            attribute.components = alike ? components : 1;
            attribute.scale = scale[piece];
            attribute.offset = offset[piece];
            attribute.description = description;
            fields_.push_back({base + used, attribute.bytes(), 0, 0});
            used += attribute.bytes();
            info_.schema.add(std::move(attribute));
        }
    }
    if (used < extra) plan_raw(base + used, extra - used);
    return true;
}

bool LasReader::read(PointBatch& batch, std::size_t max_points)
{
    const std::uint64_t left = info_.points - next_;
    const auto count = static_cast<std::size_t>(
        std::min<std::uint64_t>(left, std::min(std::max<std::size_t>(max_points, 1), batch_points_)));
    shape_batch(batch, info_.schema, true, count);
    if (count == 0) return false;

    const std::size_t stride = record_length_;
    const std::size_t buffer_points = std::max<std::size_t>(1, read_buffer_bytes / stride);
    const std::size_t block_points = std::max<std::size_t>(1, block_bytes / stride);
    buffer_.resize(std::min(buffer_points, std::max<std::size_t>(count, buffer_.size() / stride)) * stride);
    for (std::size_t done = 0; done < count;) {
        const std::size_t now = std::min(count - done, buffer_.size() / stride);
        file_.read_at(buffer_.data(), now * stride, point_offset_ + next_ * stride);
        for (std::size_t block = 0; block < now; block += block_points) {
            const std::size_t size = std::min(block_points, now - block);
            const std::byte* records = buffer_.data() + block * stride;
            for (std::size_t a = 0; a < 3; ++a)
                copy_strided<4>(records + 4 * a, stride, size,
                                reinterpret_cast<std::byte*>(batch.grid_xyz[a].data() + done + block));
            for (std::size_t f = 0; f < fields_.size(); ++f)
                copy_field(fields_[f], records, stride, size,
                           batch.attributes[f].data() + (done + block) * fields_[f].bytes);
        }
        done += now;
        next_ += now;
    }
    return true;
}

void LasReader::seek(std::uint64_t index)
{
    if (index > info_.points)
        fail(ErrorCode::invalid_argument,
             "point " + std::to_string(index) + " asked for, the file has " + std::to_string(info_.points));
    next_ = index;
}

}  // namespace

std::unique_ptr<PointReader> open_las(const std::filesystem::path& path) { return std::make_unique<LasReader>(path); }

}  // namespace pcm
