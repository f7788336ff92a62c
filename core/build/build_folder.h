// The folder a tree is built in, and how the tree gets its name when it is complete.
//
// NAME.part, next to the tree's own NAME, holds
//     building     marks the folder as a build's; locked during the build
//     tree/        becomes NAME
//     publishing   once tree/ is complete: the checksum of its index
//     old/         the tree that is replaced, where the system cannot exchange the two atomically
// and the build's scratch files. A crash at any time leaves one of these states, which the next build of the name
// distinguishes:
// - NAME is as before, or absent: the build of tree/ is resumed, or tree/ is removed;
// - NAME is absent and old/ exists (between the two renames that replace a tree where the system cannot exchange): old/
//   gets its name back first; put_back_replaced() does that too;
// - NAME has the index that `publishing` names: the build was finished, and the remains are removed.
//
// Copies of trees that are changed before they get their name (update/target.h) are made here too. Where the file
// system has no locks, a folder that this process has just made is its own, since it did not exist before; in one that
// exists a running build cannot be distinguished from an interrupted one, so it has to be removed by hand.
#pragma once

#include "pcm/system/file.h"

#include <filesystem>
#include <string>

namespace pcm {

// Who builds in a folder.
enum class Builders {
    one_process,
    // Processes of several machines. The folder stays until its tree is published, and a lock is taken where the file
    // system has one, but not needed: two builds of one tree at a time would do the same work twice.
    a_team
};

class BuildFolder {
public:
    // Takes the folder, whether new or left over. Where `output` is a symbolic link, the tree that it leads to is
    // meant. Throws what output_tree() and, for a tree to overwrite, check_replaceable_tree() throw
    // (system/output_path.h), and Error(exists | not_found | permission | no_space | io).
    BuildFolder(const std::filesystem::path& output, bool overwrite, Builders builders = Builders::one_process);
    // Removes the folder unless the tree was published; a team's stays.
    ~BuildFolder();
    BuildFolder(const BuildFolder&) = delete;
    BuildFolder& operator=(const BuildFolder&) = delete;

    const std::filesystem::path& work() const { return part_; }
    std::filesystem::path tree() const { return part_ / "tree"; }
    // Remains of an interrupted build were found, and are not cleared yet.
    bool left_over() const { return left_over_; }
    // For the report: that the file system has no locks. Empty where it has.
    std::string note() const;
    // Removes the remains of an interrupted build.
    void clear();
    // The last step, when every file of tree() is synced: it takes its name, in place of the tree to overwrite. Throws
    // what Tree::open throws when the new tree cannot be opened, and an Error that is_done() when it has its name, but
    // may not survive a loss of power, or when the remains of the build cannot be removed; after any other error the
    // old tree, if any, has the name.
    void publish();
    // Removes the folder where nothing is to be published from it. Throws what removing throws.
    void discard();

private:
    void lock(bool made);
    void settle();
    void remove_all_but_marker();
    void remove();
    std::string remove_quietly();  // returns why it could not, or nothing
    void replace_in_two_steps();

    const bool of_a_team_;
    std::filesystem::path output_, part_;
    File lock_;
    bool owned_ = false, left_over_ = false, locked_ = true;
};

// Throws Error(exists) when something is at `output` that is not a tree to overwrite, and what output_tree() and
// check_replaceable_tree() throw: for what refuses an output before hours of work.
void check_place_of_tree(const std::filesystem::path& output, bool overwrite);

// Puts the tree `output` back when an interrupted build was about to replace it and it is missing from its place.
// Returns whether it did. Throws Error(exists) while a build of this tree is running, or may be: see above.
bool put_back_replaced(const std::filesystem::path& output);

}  // namespace pcm
