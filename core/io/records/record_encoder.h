// Encodes batches of points as consecutive records of fields: the bodies of PLY and PCD files.
#pragma once

#include "pcm/cloud/point_batch.h"
#include "pcm/io/writer.h"
#include "pcm/system/output_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pcm {

// One scalar of a record, or several consecutive ones of one attribute.
struct RecordField {
    enum class Source {
        position,
        attribute,   // its raw numbers
        value,       // raw * scale + offset
        colour,      // raw * factor, rounded and clamped to 0..255
        packed_rgb,  // three colours in 32 bits
    };
    Source source = Source::position;
    // Position, value: f32 or f64. Attribute: how the bytes are printed in text. colour: u8. packed_rgb: u32 or f32.
    ScalarType type = ScalarType::f64;
    std::size_t index = 0;  // the axis, or the attribute in the schema (for packed_rgb: of three components)
    std::size_t byte = 0;   // the scalar's first byte among the attribute's bytes of a point
    std::uint32_t count = 1;
    std::optional<std::size_t> alpha;  // packed_rgb: the attribute, u8 x 1, for the highest byte; 0 without one
    double factor = 1;                 // colour, packed_rgb
    double shift = 0;                  // position: subtracted before it is rounded

    static RecordField axis(std::size_t axis, ScalarType type) { return {Source::position, type, axis, 0, 1, {}}; }
    static RecordField scalars(std::size_t attribute, std::size_t byte, ScalarType type, std::uint32_t count = 1)
    {
        return {Source::attribute, type, attribute, byte, count, {}};
    }
};

// One thread. Little endian, or lines of text: scalars are separated by blanks and have the fewest digits that read
// back as the same number (or WriteOptions.decimals, for coordinates).
class RecordEncoder {
public:
    RecordEncoder(const FileInfo& cloud, const WriteOptions& options, std::vector<RecordField> fields);

    std::size_t record_bytes() const { return record_bytes_; }  // in binary
    std::uint64_t points() const { return points_; }            // written so far
    double position_error() const { return position_error_; }   // error of coordinates that were written rounded

    // Throws Error(invalid_argument) for a batch whose shape is not the cloud's, and what writing can throw.
    void append(const PointBatch& batch, OutputFile& file);

private:
    struct Run {  // bytes that are contiguous in a record and in their column
        RecordField field;
        std::size_t bytes = 0;
        std::size_t offset = 0;  // in a record
    };
    void check(const PointBatch& batch, const OutputFile& file) const;
    double coordinate(const PointBatch& batch, std::size_t axis, std::size_t point) const;
    void put_coordinates(const PointBatch& batch, std::size_t first, std::size_t count, const Run& run, std::byte* to);
    void put_numbers(const Column& column, std::size_t first, std::size_t count, const Run& run, std::byte* to) const;
    char* put_field(const PointBatch& batch, const RecordField& field, std::size_t point, std::uint32_t component,
                    char* to, char* end);
    void append_binary(const PointBatch& batch, OutputFile& file);
    void append_text(const PointBatch& batch, OutputFile& file);
    char* put_coordinate(double value, const RecordField& field, char* to, char* end);

    std::optional<Grid> grid_;
    Schema schema_;
    bool ascii_;
    std::optional<unsigned> decimals_;
    std::vector<RecordField> fields_;
    std::vector<Run> runs_;
    std::size_t record_bytes_ = 0;
    std::uint64_t points_ = 0;
    double position_error_ = 0;
    std::string text_;
};

}  // namespace pcm
