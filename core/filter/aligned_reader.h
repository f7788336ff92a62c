// A cloud in the form that it has in a merged one.
#pragma once

#include "pcm/filter/common_grid.h"
#include "pcm/io/reader.h"

#include <memory>
#include <optional>

namespace pcm {

struct Alignment {
    std::optional<Grid> grid;            // the common grid of integers
    GridMap map;                         // to it
    Schema schema;                       // schema of the cloud, with other types
    std::optional<Attribute> source_id;  // added at the end, u16 or u32
    std::uint32_t number = 0;            // its value
    std::shared_ptr<double> rounding;    // extended by the largest change of a coordinate
};

// One thread.
class AlignedReader final : public PointReader {
public:
    AlignedReader(std::unique_ptr<PointReader> cloud, const Alignment& alignment);

    const FileInfo& info() const override;
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return cloud_->seekable(); }
    void seek(std::uint64_t index) override { cloud_->seek(index); }
    double fraction_read() const override { return cloud_->fraction_read(); }

private:
    void move_to_grid(PointBatch& batch);

    const std::unique_ptr<PointReader> cloud_;
    const Alignment to_;
    const FileInfo from_;
    Schema schema_;  // schema of the result
    mutable FileInfo info_;
    PointBatch batch_;
};

}  // namespace pcm
