// Reads BPC: the clouds that bpc_writer.h writes, and any sequence of chunks, such as a tree's data files.
//
// Gridded where all chunks lie on one grid and fit 32 bits; else doubles, the same bits as were written. With more than
// one thread the next chunks are decoded while the caller works on one.
#pragma once

#include "pcm/io/reader.h"

namespace pcm {

std::unique_ptr<PointReader> open_bpc(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace pcm
