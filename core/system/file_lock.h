// Locks of files, which distinguish programs that are running from those that were killed.
#pragma once

#include <filesystem>

namespace pcm {

enum class FileLock {
    taken,       // until the descriptor is closed, also by the end of the process
    held,        // another descriptor has the lock, of this process or another
    impossible,  // the file system or the system has no locks
};

// Takes the exclusive lock of an open file, without waiting. Throws Error(io) for other failures; `path` is for its
// text. Any thread.
FileLock take_lock(int descriptor, const std::filesystem::path& path);

}  // namespace pcm
