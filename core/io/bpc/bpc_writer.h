// Writes BPC: chunks of some 100,000 points in source order, after a cloud block with everything else that is known
// about the cloud. Nothing is lost: integers keep their grid, doubles their bits. With more than one thread, chunks are
// encoded in parallel; the bytes do not depend on the number of threads.
#pragma once

#include "pcm/io/writer.h"

namespace pcm {

std::unique_ptr<PointWriter> create_bpc(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options);

}  // namespace pcm
