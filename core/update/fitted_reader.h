// Reads a cloud in the form of a tree's points: on the tree's grid, with the tree's attributes.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/tree/source_rounding.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Every position must have a place on the tree's grid. On the grid of a source of integers (LAS) the place has the
// coordinates of the point, up to the rounding of q * scale + offset in double with another offset. On a grid that was
// made for floats it is the nearest place, at most half a step away, as in a build. Positions come as integers where
// the tree's fit 32 bits, else as doubles. Attributes must match the tree's in type, components, scale and offset;
// those that the cloud lacks become 0.
class FittedReader final : public PointReader {
public:
    // `folder` is the tree's, for messages; cloud and tree must outlive the reader. Throws Error(invalid_argument) when
    // the cloud has an attribute that the tree lacks.
    FittedReader(PointReader& cloud, const TreeInfo& tree, const std::filesystem::path& folder);

    const FileInfo& info() const override { return info_; }
    // At the first point without a place the cloud is read to its end, and Error(invalid_argument) states how many such
    // points there are, how far they are from the nearest place, and what to do; at the end also when a grid for floats
    // is too coarse for the new points: with half their mean spacing or more between its places.
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return same_grid_ && cloud_.seekable(); }
    void seek(std::uint64_t index) override { cloud_.seek(index); }
    double fraction_read() const override { return cloud_.fraction_read(); }

    // Totals so far: points without a finite position (left out of integers, still present in doubles), and the largest
    // change of a coordinate, source units.
    std::uint64_t points_skipped() const { return skipped_; }
    double position_error() const { return position_error_; }
    // Whether all new coordinates are among the numbers that readers of the tree round to (tree/source_rounding.h). If
    // not, readers must not round any more, and the error is not known better than half a step of the grid.
    bool keeps_decimals() const { return keeps_decimals_; }

private:
    void fit_attributes(PointBatch& batch);
    void fit_positions(PointBatch& batch);
    std::optional<std::int64_t> place(double value, std::size_t axis);
    [[noreturn]] void refuse();
    void refuse_coarse_grid() const;

    PointReader& cloud_;
    const TreeInfo& tree_;
    const std::filesystem::path folder_;
    const bool same_grid_;
    Vec3d source_offset_{};  // offset of the cloud's own grid
    FileInfo info_;
    std::vector<std::size_t> slots_;  // number in the tree of each attribute of the cloud
    bool same_schema_ = false;
    PointBatch batch_;
    std::uint64_t points_ = 0, skipped_ = 0, misplaced_ = 0;
    bool too_far_ = false;
    double largest_deviation_ = 0, position_error_ = 0;
    const SourceRounding rounding_;
    bool keeps_decimals_ = true;
    Box3d box_;  // box of the new points
};

}  // namespace pcm
