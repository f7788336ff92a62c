// A cloud without the points that have a coordinate beyond a limit, such as no-data values.
#pragma once

#include "pcm/io/reader.h"

#include <memory>

namespace pcm {

// Leaves out points with a coordinate above `largest` or below -`largest`; NaN is not beyond it. How many were left out
// is in info().points_left_out while points are read, and in a note with an example at the end. One thread.
class LimitedReader final : public PointReader {
public:
    // Throws Error(invalid_argument) unless `largest` is a positive number.
    LimitedReader(std::unique_ptr<PointReader> cloud, double largest);

    // The number of points is an upper bound.
    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    double fraction_read() const override { return cloud_->fraction_read(); }

private:
    void take_notes();

    const std::unique_ptr<PointReader> cloud_;
    const double largest_;
    FileInfo info_;
    Vec3d first_{};
    std::vector<std::uint32_t> kept_;
};

}  // namespace pcm
