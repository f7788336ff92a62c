// The folder a tree is built in, and how the tree gets its name when it is whole.
//
// NAME.part, beside the tree's own NAME, holds
//     building     marks the folder as a build's; locked while one is at work
//     tree/        what becomes NAME
//     publishing   from the moment that tree/ is whole: the checksum of its index
//     old/         the tree that is replaced, where the two cannot be exchanged at one stroke
// and the build's scratch files. A crash at any instant leaves one of these, which the next build of the name tells
// apart:
// - NAME is as before, or absent: tree/ is gone on with or removed;
// - NAME is absent and old/ is there (between the two renames that replace a tree where the system cannot exchange):
// old/ gets
//   its name back first; put_back_replaced() does that too;
// - NAME has the index that `publishing` names: the build was done, and what is left is removed.
#pragma once

#include "pcm/system/file.h"

#include <filesystem>

namespace pcm {

class BuildFolder {
public:
    // Takes the folder, whether new or left over. Throws Error(exists | not_found | permission | no_space | io).
    BuildFolder(const std::filesystem::path& output, bool overwrite);
    // Removes the folder unless the tree was published.
    ~BuildFolder();
    BuildFolder(const BuildFolder&) = delete;
    BuildFolder& operator=(const BuildFolder&) = delete;

    const std::filesystem::path& work() const { return part_; }
    std::filesystem::path tree() const { return part_ / "tree"; }
    // Something of an interrupted build was found, and was not cleared yet.
    bool left_over() const { return left_over_; }
    // Removes all that an interrupted build has left.
    void clear();
    // The last step, when every file of tree() is synced: it takes its name, in place of the tree to overwrite.
    void publish();

private:
    void lock();
    void settle();
    void remove_all_but_marker();
    void remove();
    void remove_quietly();

    std::filesystem::path output_, part_;
    File lock_;
    bool owned_ = false, left_over_ = false;
};

// Where an interrupted build was about to replace the tree `output`, and it is gone from its place: puts it back. True
// when it did. Throws Error(exists) while a build is at work.
bool put_back_replaced(const std::filesystem::path& output);

}  // namespace pcm
