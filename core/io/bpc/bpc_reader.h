// Reads BPC: clouds written by bpc_writer.h, and any sequence of chunks, such as a tree's data files.
//
// Gridded where all chunks have the same grid and fit 32 bits; else doubles, bit for bit as written. With more than one
// thread, the next chunks are decoded while the caller works on the current one.
#pragma once

#include "pcm/io/reader.h"

namespace pcm {

std::unique_ptr<PointReader> open_bpc(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace pcm
