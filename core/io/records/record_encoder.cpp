#include "pcm/io/records/record_encoder.h"

#include "pcm/cloud/with_type.h"
#include "pcm/io/text/text_output.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t tile_bytes = std::size_t{32} << 10;  // filled field by field; fits the first-level cache
constexpr std::size_t longest_number = 400;                // 1e308 with all its digits, the point and the decimals

template <std::size_t Bytes>
void copy(const std::byte* from, std::size_t from_stride, std::byte* to, std::size_t to_stride, std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * to_stride, from + i * from_stride, Bytes);
}

void copy(std::size_t bytes, const std::byte* from, std::size_t from_stride, std::byte* to, std::size_t to_stride,
          std::size_t count)
{
    switch (bytes) {  // constant sizes, which compile to plain moves
        case 1:
            return copy<1>(from, from_stride, to, to_stride, count);
        case 2:
            return copy<2>(from, from_stride, to, to_stride, count);
        case 3:
            return copy<3>(from, from_stride, to, to_stride, count);
        case 4:
            return copy<4>(from, from_stride, to, to_stride, count);
        case 6:
            return copy<6>(from, from_stride, to, to_stride, count);
        case 8:
            return copy<8>(from, from_stride, to, to_stride, count);
        case 12:
            return copy<12>(from, from_stride, to, to_stride, count);
        case 16:
            return copy<16>(from, from_stride, to, to_stride, count);
        case 24:
            return copy<24>(from, from_stride, to, to_stride, count);
        default:
            for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * to_stride, from + i * from_stride, bytes);
    }
}

template <class T>
T load(const std::byte* from)
{
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

std::uint8_t colour(double raw, double factor)
{
    const double byte = std::nearbyint(raw * factor);
    return static_cast<std::uint8_t>(byte >= 255 ? 255 : byte > 0 ? byte : 0);  // NaN: 0
}

std::uint32_t packed_colour(const PointBatch& batch, const RecordField& field, std::size_t point)
{
    const Column& column = batch.attributes[field.index];
    const std::uint32_t alpha = field.alpha ? batch.attributes[*field.alpha].as<std::uint8_t>()[point] : 0u;
    std::uint32_t packed = alpha;
    for (std::uint32_t c = 0; c < 3; ++c)
        packed = packed << 8 | (column.type() == ScalarType::u8 ? column.as<std::uint8_t>()[3 * point + c]
                                                                : colour(column.value(point, c), field.factor));
    return packed;
}

char* put_scalar(ScalarType type, const std::byte* from, char* to, char* end)
{
    return with_type(type, [&](auto zero) { return std::to_chars(to, end, load<decltype(zero)>(from)).ptr; });
}

}  // namespace

RecordEncoder::RecordEncoder(const FileInfo& cloud, const WriteOptions& options, std::vector<RecordField> fields)
    : grid_(cloud.grid),
      schema_(cloud.schema),
      ascii_(options.ascii),
      decimals_(options.decimals),
      fields_(std::move(fields))
{
    if (decimals_ && *decimals_ > TextOutput::most_decimals)
        throw Error(ErrorCode::invalid_argument, {},
                    std::to_string(*decimals_) + " decimals were requested, at most " +
                        std::to_string(TextOutput::most_decimals) + " can be written");
    for (const RecordField& field : fields_) {
        const std::size_t bytes = size_of(field.type) * field.count;
        if (!runs_.empty()) {
            Run& last = runs_.back();
            if (field.source == RecordField::Source::attribute && last.field.source == field.source &&
                last.field.index == field.index && last.field.byte + last.bytes == field.byte) {
                last.bytes += bytes;
                record_bytes_ += bytes;
                continue;
            }
        }
        runs_.push_back({field, bytes, record_bytes_});
        record_bytes_ += bytes;
    }
}

void RecordEncoder::check(const PointBatch& batch, const OutputFile& file) const
{
    bool same = batch.gridded == grid_.has_value() && batch.attributes.size() == schema_.size();
    for (std::size_t i = 0; same && i < schema_.size(); ++i)
        same = batch.attributes[i].type() == schema_[i].type &&
               batch.attributes[i].components() == schema_[i].components && batch.attributes[i].size() == batch.size;
    for (std::size_t a = 0; same && a < 3; ++a)
        same = (batch.gridded ? batch.grid_xyz[a].size() : batch.xyz[a].size()) == batch.size;
    if (!same)
        throw Error(ErrorCode::invalid_argument, file.path(),
                    "the batch has other attributes than the cloud that the file was created for");
}

double RecordEncoder::coordinate(const PointBatch& batch, std::size_t axis, std::size_t point) const
{
    return grid_ ? grid_->to_source(batch.grid_xyz[axis][point], axis) : batch.xyz[axis][point];
}

void RecordEncoder::put_coordinates(const PointBatch& batch, std::size_t first, std::size_t count, const Run& run,
                                    std::byte* to)
{
    const std::size_t axis = run.field.index;
    const double shift = run.field.shift;
    const auto put = [&](auto value_of) {
        if (run.field.type == ScalarType::f64) {
            for (std::size_t i = 0; i < count; ++i, to += record_bytes_) {
                const double value = value_of(first + i);
                std::memcpy(to, &value, sizeof value);
            }
            return;
        }
        double error = 0;
        for (std::size_t i = 0; i < count; ++i, to += record_bytes_) {
            const double value = value_of(first + i);
            const auto single = static_cast<float>(value - shift);
            std::memcpy(to, &single, sizeof single);
            const double off = std::fabs(static_cast<double>(single) + shift - value);
            error = off > error ? off : error;  // the difference is NaN for a NaN coordinate: not an error
        }
        position_error_ = std::max(position_error_, error);
    };
    if (grid_) {
        const std::int32_t* q = batch.grid_xyz[axis].data();
        put([&, grid = *grid_](std::size_t i) { return grid.to_source(q[i], axis); });
    } else {
        const double* x = batch.xyz[axis].data();
        put([x](std::size_t i) { return x[i]; });
    }
}

// Values and colours.
void RecordEncoder::put_numbers(const Column& column, std::size_t first, std::size_t count, const Run& run,
                                std::byte* to) const
{
    const RecordField& field = run.field;
    const Attribute& attribute = schema_[field.index];
    const std::size_t size = size_of(field.type);
    const std::size_t component = field.byte / size_of(attribute.type), components = column.components();
    with_type(column.type(), [&](auto zero) {
        const auto* raw = column.as<decltype(zero)>() + first * components + component;
        for (std::size_t i = 0; i < count; ++i, to += record_bytes_, raw += components)
            for (std::uint32_t k = 0; k < field.count; ++k) {
                const auto number = static_cast<double>(raw[k]);
                if (field.source == RecordField::Source::colour) {
                    to[k] = static_cast<std::byte>(colour(number, field.factor));
                    continue;
                }
                const double value = number * attribute.scale + attribute.offset;
                const auto single = static_cast<float>(value);
                if (field.type == ScalarType::f32)
                    std::memcpy(to + k * size, &single, sizeof single);
                else
                    std::memcpy(to + k * size, &value, sizeof value);
            }
    });
}

void RecordEncoder::append_binary(const PointBatch& batch, OutputFile& file)
{
    const std::size_t tile = std::max<std::size_t>(1, tile_bytes / record_bytes_);
    for (std::size_t first = 0; first < batch.size; first += tile) {
        const std::size_t count = std::min(tile, batch.size - first);
        std::byte* const records = file.extend(count * record_bytes_);
        for (const Run& run : runs_) {
            std::byte* to = records + run.offset;
            if (run.field.source == RecordField::Source::position) {
                put_coordinates(batch, first, count, run, to);
            } else if (run.field.source == RecordField::Source::attribute) {
                const Column& column = batch.attributes[run.field.index];
                const std::size_t stride = column.point_bytes();
                copy(run.bytes, column.data() + first * stride + run.field.byte, stride, to, record_bytes_, count);
            } else if (run.field.source != RecordField::Source::packed_rgb) {
                put_numbers(batch.attributes[run.field.index], first, count, run, to);
            } else {
                for (std::size_t i = 0; i < count; ++i, to += record_bytes_) {
                    const std::uint32_t packed = packed_colour(batch, run.field, first + i);
                    std::memcpy(to, &packed, sizeof packed);
                }
            }
        }
    }
}

char* RecordEncoder::put_coordinate(double value, const RecordField& field, char* to, char* end)
{
    const auto single = static_cast<float>(value - field.shift);
    if (!decimals_ || !std::isfinite(value)) {
        if (field.type == ScalarType::f64) return std::to_chars(to, end, value).ptr;
        const double off = std::fabs(static_cast<double>(single) + field.shift - value);
        if (off > position_error_) position_error_ = off;
        return std::to_chars(to, end, single).ptr;
    }
    char* const stop =
        std::to_chars(to, end, value - field.shift, std::chars_format::fixed, static_cast<int>(*decimals_)).ptr;
    double back = 0;
    std::from_chars(to, stop, back);
    if (field.type == ScalarType::f32) back = static_cast<double>(static_cast<float>(back));
    position_error_ = std::max(position_error_, std::fabs(back + field.shift - value));
    return stop;
}

char* RecordEncoder::put_field(const PointBatch& batch, const RecordField& field, std::size_t point,
                               std::uint32_t component, char* to, char* end)
{
    using Source = RecordField::Source;
    if (field.source == Source::position) return put_coordinate(coordinate(batch, field.index, point), field, to, end);
    if (field.source == Source::packed_rgb) return std::to_chars(to, end, packed_colour(batch, field, point)).ptr;
    const Column& column = batch.attributes[field.index];
    const Attribute& attribute = schema_[field.index];
    if (field.source != Source::attribute)
        component += static_cast<std::uint32_t>(field.byte / size_of(attribute.type));
    if (field.source == Source::colour)
        return std::to_chars(to, end, unsigned{colour(column.value(point, component), field.factor)}).ptr;
    if (field.source == Source::attribute)
        return put_scalar(field.type,
                          column.data() + point * column.point_bytes() + field.byte + component * size_of(field.type),
                          to, end);
    const double value = column.value(point, component) * attribute.scale + attribute.offset;
    return field.type == ScalarType::f32 ? std::to_chars(to, end, static_cast<float>(value)).ptr
                                         : std::to_chars(to, end, value).ptr;
}

void RecordEncoder::append_text(const PointBatch& batch, OutputFile& file)
{
    constexpr std::size_t flush_at = std::size_t{256} << 10;
    text_.resize(flush_at + longest_number);
    char* to = text_.data();
    char* const end = text_.data() + text_.size();
    const auto end_number = [&](char separator) {
        *to++ = separator;
        if (static_cast<std::size_t>(to - text_.data()) < flush_at) return;
        file.append(text_.data(), static_cast<std::size_t>(to - text_.data()));
        to = text_.data();
    };
    for (std::size_t i = 0; i < batch.size; ++i)
        for (std::size_t f = 0; f < fields_.size(); ++f) {
            const RecordField& field = fields_[f];
            const char last = f + 1 == fields_.size() ? '\n' : ' ';
            for (std::uint32_t k = 0; k < field.count; ++k) {
                to = put_field(batch, field, i, k, to, end);
                end_number(k + 1 == field.count ? last : ' ');
            }
        }
    file.append(text_.data(), static_cast<std::size_t>(to - text_.data()));
}

void RecordEncoder::append(const PointBatch& batch, OutputFile& file)
{
    check(batch, file);
    if (ascii_)
        append_text(batch, file);
    else
        append_binary(batch, file);
    points_ += batch.size;
}

}  // namespace pcm
