// The lock that allows one writer of a tree at a time.
#pragma once

#include "pcm/system/file.h"

#include <filesystem>

namespace pcm {

inline constexpr const char* lock_file_name = "lock";  // an empty file in the tree's folder; it is never removed

// Held while a tree is changed; excludes other processes and other threads. The system releases it when the process
// ends, also after a crash. Readers need no lock.
class TreeLock {
public:
    // Locks the tree in `folder`. Throws Error(exists) when another process or thread holds the lock, and
    // Error(permission | no_space | io).
    explicit TreeLock(const std::filesystem::path& folder);

private:
    File file_;
};

}  // namespace pcm
