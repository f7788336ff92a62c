#include "pcm/io/pts/pts_writer.h"

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/metadata_text.h"
#include "pcm/io/text/text_output.h"
#include "pcm/system/counted.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

constexpr std::size_t count_width = 20;  // digits of the largest 64-bit number

// Finds an attribute that PTS has columns for.
std::optional<std::size_t> find(const Schema& schema, std::string_view name, std::uint32_t components)
{
    const auto i = schema.find(name);
    return i && schema[*i].components == components ? i : std::nullopt;
}

class PtsWriter final : public PointWriter {
public:
    PtsWriter(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options)
        : schema_(cloud.schema),
          intensity_(find(schema_, attribute_name::intensity, 1)),
          rgb_(find(schema_, attribute_name::rgb, 3)),
          out_(path, cloud, options)
    {
        out_.put(std::string(count_width, ' ') + "\n");
        if (const std::string system = crs_comment_line(cloud.metadata); !system.empty())
            metadata_notes_.push_back("PTS has no place for the coordinate system (" + system + ")");
        if (std::string note = unwritten_note("PTS", cloud.metadata); !note.empty())
            metadata_notes_.push_back(std::move(note));
    }

    void write(const PointBatch& batch) override
    {
        out_.check(batch);
        for (std::size_t point = 0; point < batch.size; ++point) {
            out_.put_position(batch, point, ' ');
            if (intensity_) put_intensity(batch.attributes[*intensity_], point);
            if (rgb_) {
                if (!intensity_) {
                    out_.put(' ');
                    out_.put('0');
                }
                put_colour(batch.attributes[*rgb_], point);
            }
            out_.put('\n');
        }
        points_ += batch.size;
    }

    void finish() override
    {
        out_.flush();
        const std::string count = std::to_string(points_);
        out_.file().rewrite(count.data(), count.size(), 0);
        out_.file().finish();
    }

    double position_error() const override { return out_.position_error(); }
    std::vector<std::string> notes() const override;

private:
    void put_intensity(const Column& column, std::size_t point);
    void put_colour(const Column& column, std::size_t point);

    const Schema schema_;
    const std::optional<std::size_t> intensity_, rgb_;
    TextOutput out_;
    std::vector<std::string> metadata_notes_;
    std::uint64_t points_ = 0;
    std::uint64_t odd_intensities_ = 0;  // not integers of the range
    double least_intensity_ = std::numeric_limits<double>::infinity();
    double largest_intensity_ = -std::numeric_limits<double>::infinity();
    std::uint64_t rounded_colours_ = 0, cut_colours_ = 0;  // points
    std::uint16_t largest_colour_ = 0;                     // for 16-bit colours
};

void PtsWriter::put_intensity(const Column& column, std::size_t point)
{
    const Attribute& attribute = schema_[*intensity_];
    const double value = column.value(point) * attribute.scale + attribute.offset;
    least_intensity_ = std::min(least_intensity_, value);
    largest_intensity_ = std::max(largest_intensity_, value);
    if (!(value >= -2048 && value <= 2047 && value == std::floor(value))) ++odd_intensities_;
    out_.put(' ');
    out_.put_scalar(attribute, column, point);
}

void PtsWriter::put_colour(const Column& column, std::size_t point)
{
    const Attribute& attribute = schema_[*rgb_];
    const bool as_it_is = attribute.scale == 1 && attribute.offset == 0;
    bool rounded = false, cut = false;
    for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t colour = 0;
        if (column.type() == ScalarType::u8 && as_it_is) {
            colour = column.as<std::uint8_t>()[3 * point + k];
        } else if (column.type() == ScalarType::u16 && as_it_is) {
            const std::uint16_t value = column.as<std::uint16_t>()[3 * point + k];
            largest_colour_ = std::max(largest_colour_, value);
            colour = (value + 128u) / 257u;
            rounded = rounded || colour * 257u != value;
        } else {
            double value = column.value(point, static_cast<std::uint32_t>(k)) * attribute.scale + attribute.offset;
            const bool fraction = column.type() == ScalarType::f32 || column.type() == ScalarType::f64;
            if (fraction) value *= 255;  // colours in floats are 0..1
            const bool inside = value >= 0 && value <= 255;
            cut = cut || !inside;
            const double whole = std::isnan(value) ? 0 : std::round(std::clamp(value, 0.0, 255.0));
            colour = static_cast<std::uint32_t>(whole);
            // A float nearest to n/255 counts as n.
            const double slack = column.type() == ScalarType::f32 ? 255 * 0x1p-24 : fraction ? 255 * 0x1p-53 : 0;
            rounded = rounded || (inside && std::abs(value - whole) > slack);
        }
        out_.put(' ');
        out_.put_integer(colour);
    }
    rounded_colours_ += rounded;
    cut_colours_ += cut;
}

std::vector<std::string> PtsWriter::notes() const
{
    std::vector<std::string> notes = metadata_notes_;
    std::string left_out;
    for (std::size_t i = 0; i < schema_.size(); ++i)
        if (i != intensity_ && i != rgb_) left_out += (left_out.empty() ? "" : ", ") + schema_[i].name;
    if (!left_out.empty()) notes.push_back("PTS cannot store " + left_out + ": not written");
    if (rgb_ && !intensity_) notes.push_back("PTS needs intensities before colours: all are written as 0");
    if (odd_intensities_)
        notes.push_back("intensities of PTS are integers from -2048 to 2047; " + grouped(odd_intensities_) +
                        " are not and were written unchanged (they are from " + exact(least_intensity_) + " to " +
                        exact(largest_intensity_) + ")");
    if (rounded_colours_)
        notes.push_back("colours of PTS are 0..255: those of " +
                        counted(rounded_colours_, "point", "was rounded", "were rounded"));
    if (rounded_colours_ && largest_colour_ && largest_colour_ <= 255)
        notes.push_back("the largest colour is " + std::to_string(largest_colour_) +
                        " of 65535, so all were written as 0 or 1: perhaps the source means 0..255");
    if (cut_colours_)
        notes.push_back("colours of " + points_text(cut_colours_) + " were out of range and were clamped");
    return notes;
}

}  // namespace

std::unique_ptr<PointWriter> create_pts(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options)
{
    return std::make_unique<PtsWriter>(path, cloud, options);
}

}  // namespace pcm
