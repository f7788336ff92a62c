// A given number of a tree's points, evenly spread.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/tree/tree_reader.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

// The exact number of subsample.h. One thread.
class NumberedPoints final : public PointReader {
public:
    NumberedPoints(std::shared_ptr<const Tree> tree, std::uint64_t points, unsigned chunks_ahead);

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    double fraction_read() const override { return cloud_->fraction_read(); }

private:
    // Consecutive points of the reader.
    struct Run {
        std::uint32_t points = 0;
        bool whole = true;  // all of them are taken; else those of the level that is taken in part
    };
    void thin(PointBatch& batch);

    FileInfo info_;
    std::unique_ptr<TreeReader> cloud_;
    std::vector<Run> runs_;
    std::size_t run_ = 0;
    std::uint32_t in_run_ = 0;
    std::uint64_t wanted_ = 0, all_ = 1;  // counts of the level that is taken in part
    std::uint64_t due_ = 0;               // in all_ parts of a point
    std::vector<std::uint32_t> kept_;
};

}  // namespace pcm
