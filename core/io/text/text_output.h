// Writes points as lines of text: shared by the writers of XYZ and PTS.
#pragma once

#include "pcm/cloud/point_batch.h"
#include "pcm/io/writer.h"
#include "pcm/system/output_file.h"
#include "pcm/system/scaled_decimal.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

// One thread. Lines are collected in a small buffer and appended to the file.
class TextOutput {
public:
    // Throws Error(invalid_argument) for more decimals than most_decimals, and what opening a file can throw.
    TextOutput(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options);

    OutputFile& file() { return file_; }

    // Throws Error(invalid_argument) unless the batch has the shape that the cloud's info promised.
    void check(const PointBatch& batch) const;

    void put(char c);
    void put(std::string_view text);
    void put_integer(std::uint64_t value);
    // x, y and z of a point, separated by `separator`. Positions on a grid, or near one, are the decimals that they
    // stand for (scaled_decimal.h): they read back as the same place of the grid. Others have the fewest digits that
    // read back as the same double. All have WriteOptions::decimals where that is given. NaN is "nan", the infinities
    // are "inf" and
    // "-inf".
    void put_position(const PointBatch& batch, std::size_t point, char separator);
    // The value of the raw scalar `index` of a column, with the fewest digits that read back as the same number: an
    // integer or float of the column's own type; with scale and offset the decimal number of an integer, the double raw
    // * scale + offset of a float.
    void put_scalar(const Attribute& attribute, const Column& column, std::size_t index);
    void put_number(double value);

    // Maximum difference between a written and a source coordinate, in source units.
    double position_error() const { return position_error_; }
    // Writes the buffered text to the file; the caller finishes the file.
    void flush();

    static constexpr unsigned most_decimals = 30;

private:
    // Space for one more number or short word; longer words are written in pieces.
    char* room();
    // The coordinate as the decimal number that its place on the grid stands for. False: nothing was written.
    bool put_on_grid(const PointBatch& batch, std::size_t point, std::size_t axis);
    const ScaledDecimal& scaled(double scale, double offset);

    const Schema schema_;
    const std::optional<Grid> grid_, near_grid_;
    std::vector<ScaledDecimal> axes_;    // decimals of the grid, or of the near one
    std::vector<ScaledDecimal> scaled_;  // decimals of attributes
    const std::optional<unsigned> decimals_;
    OutputFile file_;
    double position_error_ = 0;
    std::array<char, 65536> buffer_;
    std::size_t used_ = 0;
};

}  // namespace pcm
