// The input of a build as one cloud: several readers, one schema, one grid, rows.
#pragma once

#include "io/reader.h"
#include "tree/row.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// What the files have in common, found from their headers.
//
// Attributes merge by name: the cloud has those of every file, zero where a file lacks one; attributes of one name that differ
// in type are kept apart. Grid: that of the files where all share one (positions pass through bit for bit); else a grid
// of a power of two, fine enough for the largest coordinate, which is known only after a first look at the points.
class InputCloud {
public:
    explicit InputCloud(const std::vector<std::filesystem::path>& inputs);

    const Schema& schema() const { return schema_; }
    // Exact for files that say how many points they hold, which all seekable ones do; of others an estimate.
    std::uint64_t promised_points() const { return promised_points_; }
    ScalarType position_type() const { return position_type_; }
    std::vector<std::string> source_names() const;
    std::vector<Metadata> metadata() const;
    const std::vector<std::string>& notes() const { return notes_; }

    // One 32-bit grid for all files, known from their headers.
    bool shares_grid() const { return shares_grid_; }
    const Grid& grid() const { return grid_; }
    // All readers can seek: points can be sampled before they are read.
    bool seekable() const { return seekable_; }

    // The next batch of the whole input, file after file; false at the end. `reader()` is where it came from.
    bool read(PointBatch& batch, std::size_t max_points);
    std::size_t reader() const { return current_; }
    double fraction_read() const;

    // `count` points spread evenly over the input, in order (only when seekable and shares_grid): grid coordinates.
    std::vector<Vec3i> sample(std::size_t count);

    // Where the files lie on grids of one scale whose offsets are whole steps apart: the first file's grid, on which all of
    // them are exact. `largest` is the largest magnitude of the coordinates an axis.
    std::optional<Grid> common_grid(const Vec3d& largest) const;

    // For each attribute of a reader, its place in schema().
    const std::vector<std::size_t>& slots(std::size_t reader) const { return slots_[reader]; }
    const Grid* grid_of(std::size_t reader) const { return infos_[reader].grid ? &*infos_[reader].grid : nullptr; }

private:
    PointReader& open(std::size_t reader);

    std::vector<std::filesystem::path> paths_;
    std::vector<FileInfo> infos_;
    bool seekable_ = true;
    std::unique_ptr<PointReader> open_;  // one at a time: a survey may have more tiles than a process may have open files
    std::size_t open_index_ = 0;
    std::vector<std::vector<std::size_t>> slots_;
    Schema schema_;
    Grid grid_;
    bool shares_grid_ = false;
    ScalarType position_type_ = ScalarType::f64;
    std::uint64_t promised_points_ = 0;
    std::size_t current_ = 0;
    std::vector<std::string> notes_;
};

// Position columns that rows are made of, for a batch whose coordinates are already on the cloud's grid.
// `rows` gets batch.size rows; attributes are taken through `slots` (InputCloud::slots of the batch's reader) and those the
// file lacks are zero.
void put_attributes(const PointBatch& batch, const RowLayout& layout, const std::vector<std::size_t>& slots,
                    std::byte* rows);

// The step of an axis' power-of-two grid for float sources: 2^(e-61) where every |coordinate| < 2^e, offset 0. A double of the
// size of the largest coordinate is exact on it with 8 bits to spare; any coordinate is off by at most half a step.
double power_of_two_step(double largest_magnitude);

// Nearest grid position. Throws nothing; |value| must be below the magnitude the grid was made for.
std::int64_t to_grid_position(double value, double scale, double offset);

}  // namespace pcm
