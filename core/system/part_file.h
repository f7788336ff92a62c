// Files and folders next to an output while it is being written: NAME.part-PROCESS-NUMBER.
#pragma once

#include "pcm/system/file.h"

#include <filesystem>
#include <string>

namespace pcm {

// Unique among those of this process and of all others running. Any thread.
std::filesystem::path new_part_name(const std::filesystem::path& output);
// Whether `name` is such a name of the output `output`, both without folders.
bool is_part_name(const std::string& name, const std::string& output);

// A new file of such a name, locked where the file system has locks.
File make_part(const std::filesystem::path& output);
// Gives a synced file without a name (File::without_name()) such a name and returns it. Where the system cannot do
// that, `file` becomes a synced copy that has the name.
std::filesystem::path name_part(File& file, const std::filesystem::path& output);
// Removes parts of `output` that no program has locked: their processes were killed. Where the file system has no locks
// they stay.
void remove_abandoned_parts(const std::filesystem::path& output);

}  // namespace pcm
