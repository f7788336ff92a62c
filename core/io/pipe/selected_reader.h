// Part of a cloud while it is read: the selected points with the selected attributes.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/io/reader.h"

#include <cstdint>
#include <memory>

namespace pcm {

// The selection of another reader's cloud. One thread.
class SelectedReader final : public PointReader {
public:
    // Throws what Selector throws. `passed`, if given, is extended by the finite positions that are read until the
    // first point is selected.
    SelectedReader(std::unique_ptr<PointReader> cloud, const Selection& selection,
                   std::shared_ptr<Box3d> passed = nullptr);

    // The number of points is known when none is left out.
    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return !selector_.tests_points() && cloud_->seekable(); }
    void seek(std::uint64_t index) override;
    double fraction_read() const override { return cloud_->fraction_read(); }

    std::uint64_t points_seen() const { return seen_; }  // points of the other cloud so far

private:
    void pass(const PointBatch& batch);

    std::unique_ptr<PointReader> cloud_;
    Selector selector_;
    FileInfo info_;
    PointBatch whole_;
    std::uint64_t seen_ = 0;
    std::shared_ptr<Box3d> passed_;  // null once a point is selected
};

}  // namespace pcm
