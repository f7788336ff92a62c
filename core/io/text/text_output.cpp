#include "pcm/io/text/text_output.h"

#include "pcm/cloud/with_type.h"
#include "pcm/io/pipe/grid_choice.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

namespace pcm {
namespace {

// The longest number: a sign, 309 digits, the point, and most_decimals.
constexpr std::size_t longest_number = 1 + 309 + 1 + TextOutput::most_decimals;

// Returns the end of the written text; `to` has longest_number bytes.
template <class T>
char* shortest(char* to, T value)
{
    char* const end = to + longest_number;
    if constexpr (std::is_floating_point_v<T>) {
        if (std::isnan(value)) {  // without the sign that to_chars would show
            std::memcpy(to, "nan", 3);
            return to + 3;
        }
        // Coordinates as people write them: 1000000, not 1e+06.
        const T size = std::abs(value);
        if (size == 0 || (size >= T(1e-5) && size < T(1e15)))
            return std::to_chars(to, end, value, std::chars_format::fixed).ptr;
    }
    return std::to_chars(to, end, value).ptr;
}

}  // namespace

TextOutput::TextOutput(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options)
    : schema_(cloud.schema), grid_(cloud.grid), near_grid_(cloud.near_grid), decimals_(options.decimals), file_(path)
{
    if (const auto& grid = grid_ ? grid_ : near_grid_)
        for (std::size_t a = 0; a < 3; ++a) axes_.emplace_back(grid->scale[a], grid->offset[a]);
    if (decimals_ && *decimals_ > most_decimals)
        throw Error(ErrorCode::invalid_argument, path,
                    std::to_string(*decimals_) + " decimals were requested, at most " + std::to_string(most_decimals) +
                        " can be written");
}

void TextOutput::check(const PointBatch& batch) const
{
    bool same = batch.gridded == grid_.has_value() && batch.attributes.size() == schema_.size();
    for (std::size_t i = 0; same && i < schema_.size(); ++i) {
        const Column& column = batch.attributes[i];
        same = column.type() == schema_[i].type && column.components() == schema_[i].components &&
               column.size() >= batch.size;
    }
    if (!same)
        throw Error(ErrorCode::invalid_argument, file_.path(),
                    "the batch has other attributes than the cloud that the file was created for");
}

char* TextOutput::room()
{
    if (buffer_.size() - used_ < longest_number) flush();
    return buffer_.data() + used_;
}

void TextOutput::flush()
{
    file_.append(buffer_.data(), used_);
    used_ = 0;
}

void TextOutput::put(char c)
{
    *room() = c;
    ++used_;
}

void TextOutput::put(std::string_view text)
{
    flush();
    file_.append(text);
}

void TextOutput::put_integer(std::uint64_t value)
{
    char* const to = room();
    used_ += static_cast<std::size_t>(shortest(to, value) - to);
}

void TextOutput::put_number(double value)
{
    char* const to = room();
    used_ += static_cast<std::size_t>(shortest(to, value) - to);
}

bool TextOutput::put_on_grid(const PointBatch& batch, std::size_t point, std::size_t axis)
{
    if (axes_.empty()) return false;
    std::int64_t q;
    if (batch.gridded) {
        q = batch.grid_xyz[axis][point];
    } else {
        // The double is q * scale + offset of this grid or of one that is whole steps apart, each rounded.
        const double value = batch.xyz[axis][point];
        if (!std::isfinite(value)) return false;
        q = nearest_on_grid(*near_grid_, axis, value);
        const double place = near_grid_->to_source(q, axis);
        const double size = std::max(std::abs(value), std::abs(near_grid_->offset[axis]));
        if (std::abs(place - value) > 2 * std::numeric_limits<double>::epsilon() * size) return false;
    }
    char* const to = room();
    char* const end = axes_[axis].write(to, q);
    if (!end) return false;
    used_ += static_cast<std::size_t>(end - to);
    return true;
}

const ScaledDecimal& TextOutput::scaled(double scale, double offset)
{
    for (const ScaledDecimal& known : scaled_)
        if (known.scale() == scale && known.offset() == offset) return known;
    return scaled_.emplace_back(scale, offset);
}

void TextOutput::put_position(const PointBatch& batch, std::size_t point, char separator)
{
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double value =
            batch.gridded ? grid_->to_source(batch.grid_xyz[axis][point], axis) : batch.xyz[axis][point];
        if (axis) put(separator);
        if (!decimals_ && put_on_grid(batch, point, axis)) continue;
        if (!decimals_ || !std::isfinite(value)) {
            put_number(value);
            continue;
        }
        char* const to = room();
        char* end =
            std::to_chars(to, to + longest_number, value, std::chars_format::fixed, static_cast<int>(*decimals_)).ptr;
        double written = value;
        std::from_chars(to, end, written);
        if (written == 0 && value != 0 && *to == '-') {  // 0.00, not -0.00
            std::memmove(to, to + 1, static_cast<std::size_t>(end - to) - 1);
            --end;
        }
        used_ += static_cast<std::size_t>(end - to);
        position_error_ = std::max(position_error_, std::abs(written - value));
    }
}

void TextOutput::put_scalar(const Attribute& attribute, const Column& column, std::size_t index)
{
    const bool raw = attribute.scale == 1 && attribute.offset == 0;
    char* const to = room();
    char* end = to;
    with_type(column.type(), [&](auto zero) {
        using T = decltype(zero);
        const T value = column.as<T>()[index];
        end = nullptr;
        if constexpr (std::is_integral_v<T>)
            if (!raw && static_cast<double>(value) < 9e18)
                end = scaled(attribute.scale, attribute.offset).write(to, static_cast<std::int64_t>(value));
        if (!end)
            end = raw ? shortest(to, value)
                      : shortest(to, static_cast<double>(value) * attribute.scale + attribute.offset);
    });
    used_ += static_cast<std::size_t>(end - to);
}

}  // namespace pcm
