// The folder a tree is built in, until it is whole.
#pragma once

#include "cloud/file.h"

#include <filesystem>

namespace pcm {

// NAME.part beside the tree's own name, locked against other builds. What an interrupted build has left in it is removed. Whatever
// ends before publish() removes the folder.
class BuildFolder {
public:
    // Throws Error(exists | not_found | permission | no_space | io).
    BuildFolder(const std::filesystem::path& output, bool overwrite);
    ~BuildFolder();
    BuildFolder(const BuildFolder&) = delete;
    BuildFolder& operator=(const BuildFolder&) = delete;

    const std::filesystem::path& path() const { return part_; }
    // The last step, when every file is synced: the tree takes its name, in place of the one to overwrite.
    void publish();

private:
    std::filesystem::path output_, part_;
    File lock_;
    bool owned_ = false;
};

}  // namespace pcm
