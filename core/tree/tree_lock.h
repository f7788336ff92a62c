// The lock that allows one writer of a tree at a time.
#pragma once

#include "pcm/system/file.h"
#include "pcm/system/tree_folder.h"

#include <filesystem>

namespace pcm {

// Held while a tree is changed; excludes other processes and other threads. The system releases it when the process
// ends, also after a crash. Readers need no lock.
class TreeLock {
public:
    // Locks the tree in `folder`. Throws Error(exists) when another process or thread holds the lock,
    // Error(unsupported) when the lock is not a regular file (a symbolic link is not followed) and where the file
    // system has no locks, but for a tree in the folder of a build, and Error(permission | no_space | io).
    explicit TreeLock(const std::filesystem::path& folder);

private:
    File file_;
};

}  // namespace pcm
