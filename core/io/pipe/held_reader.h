// Reads points that are in memory.
#pragma once

#include "pcm/io/reader.h"

#include <cstddef>
#include <memory>

namespace pcm {

// Replaces `to` by the points of `from` from number `first` on: as many as there are, at most `most`, and no more than
// fit a batch. Returns their number. Both are of `schema`.
std::size_t copy_some(const PointBatch& from, std::size_t first, const Schema& schema, std::size_t most,
                      PointBatch& to);

// Several readers may share the points; each is for one thread.
class HeldReader final : public PointReader {
public:
    // `info` describes the points.
    HeldReader(std::shared_ptr<const PointBatch> points, FileInfo info);

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    double fraction_read() const override;

private:
    std::shared_ptr<const PointBatch> points_;
    FileInfo info_;
    std::size_t next_ = 0;
};

}  // namespace pcm
