// A folder for large temporary files next to an output.
#pragma once

#include "pcm/system/file.h"

#include <filesystem>

namespace pcm {

// NAME.part-PROCESS-NUMBER next to the output NAME. In it are a marker, locked as long as this object lives, and the
// folder work() for the caller's files, which the destructor removes with it. Folders that killed processes have left
// are removed by the next ScratchFolder of the same output: those that have the marker and whose lock is free, and of
// these nothing but marker and work folder. Where the file system has no locks they stay. For one thread.
class ScratchFolder {
public:
    // `output` as output_tree() or output_file() return it. Throws Error(not_found | permission | no_space | io).
    explicit ScratchFolder(const std::filesystem::path& output);
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    std::filesystem::path work() const { return path_ / "work"; }

private:
    bool make();

    std::filesystem::path path_;
    File marker_;
};

}  // namespace pcm
