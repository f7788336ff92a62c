// The batches in which a team reads a cloud.
#pragma once

#include <cstdint>
#include <vector>

namespace pcm {

struct Batch {
    std::uint64_t first, end;  // numbers of points in the cloud
};

// Batches of about `size` points, which begin with a file or a multiple of `size` points behind its beginning: a file
// that is compressed in chunks is seldom entered in the middle of one. Small files are joined.
std::vector<Batch> batches_of(const std::vector<std::uint64_t>& points_of_files, std::uint64_t size);

// Points of a batch, for a cloud of `points`: enough batches for many ranks, of a size that chunks divide.
std::uint64_t batch_size(std::uint64_t points);

}  // namespace pcm
