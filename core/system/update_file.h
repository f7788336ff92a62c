// A small file that is read, changed and replaced as one step, by any number of processes at once.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

namespace pcm {

// `change` reads the file, which may not exist yet, and returns what it is to hold; OutputFile replaces the file by
// that, atomically. No other call of this function, in any process, runs a `change` for a file in the same folder
// meanwhile: the folder is locked (flock), since a file that is replaced takes its lock along. The lock leaves nothing
// behind. Where the file system has no locks, and against programs that do not lock, the file is compared by identity,
// size and times directly before it is replaced: if it is not the one that was read, `change` runs again. What changes
// it between that and the rename, a few microseconds later, is lost.
//
// Throws Error(io) when the folder stays locked for `patience`, or the file changes during each of 100 attempts; and
// what `change` and OutputFile throw. The file is unchanged then.
void update_file(const std::filesystem::path& file, const std::function<std::string()>& change,
                 std::chrono::milliseconds patience = std::chrono::seconds(60));

}  // namespace pcm
