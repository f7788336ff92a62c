// One writer at a time.
#pragma once

#include "pcm/system/file.h"

#include <filesystem>

namespace pcm {

inline constexpr const char* lock_file_name = "lock";  // in the tree's folder, empty; it stays there

// Held by whoever changes a tree, against other processes and other threads. The system lets go of it when the process
// ends, however it ends. Readers need none.
class TreeLock {
public:
    // `folder` is a tree's. Throws Error(exists) when somebody else holds it, Error(permission | no_space | io).
    explicit TreeLock(const std::filesystem::path& folder);

private:
    File file_;
};

}  // namespace pcm
