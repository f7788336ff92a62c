// Thins a tree to exactly a spacing.
#pragma once

#include "pcm/io/reader.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <memory>

namespace pcm {

// The exact spacing of subsample.h. One thread calls; `threads` read ahead.
class SpacedPoints final : public PointReader {
public:
    SpacedPoints(std::shared_ptr<const Tree> tree, double spacing, std::uint64_t memory_bytes, unsigned threads);
    ~SpacedPoints() override;

    // The number of points is an upper bound until all are read.
    const FileInfo& info() const override;
    bool read(PointBatch& batch, std::size_t max_points) override;
    double fraction_read() const override;

private:
    class Work;
    std::unique_ptr<Work> work_;
};

}  // namespace pcm
