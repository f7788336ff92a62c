// A tree put into a bucket, whole or not at all.
#pragma once

#include "pcm/system/progress.h"

#include <cstdint>
#include <filesystem>

namespace pcm {

// What an upload to `address` (s3://BUCKET/PATH) would be refused for, before the work that makes the tree: throws
// Error(unsupported) for an address that is not s3 or where no address can be opened, Error(exists) where there is a
// tree and `overwrite` is not given, and what the server refuses.
void refuse_upload(const std::filesystem::path& address, bool overwrite);

// Sends the files of `tree`, a folder of this machine, its index last: until it is there nobody sees a tree at the
// address. A tree that is replaced loses its index first, and what it had more of data files last. Returns the bytes
// sent. After an error there is no tree at the address; the same call again starts anew. Throws what refuse_upload(),
// Tree::open() and BucketObject do, and Error(cancelled).
std::uint64_t upload_tree(const std::filesystem::path& tree, const std::filesystem::path& address, bool overwrite,
                          const ProgressFunction& progress);

}  // namespace pcm
