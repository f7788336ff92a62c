// Where the result of an update goes: into the tree itself, or into a copy of it.
#pragma once

#include "pcm/system/progress.h"

#include <filesystem>
#include <string>
#include <vector>

namespace pcm {

// The user's choice. Exactly one of the two must be made, so that no tree is changed by an option left out.
struct TargetChoice {
    std::filesystem::path copy;  // folder of the tree to write; empty: no copy
    bool in_place = false;       // change the tree itself
};

// The tree that an update (append_points, erase_points, TreeChanges) is to change:
//
//     UpdateTarget target(tree, choice);
//     append_points(target.path(), cloud, names);
//     target.keep();
//
// A copy is made by the constructor. It shares the data files of the original where the file system has hard links, so
// it takes little time and space. The destructor removes a copy that was not kept, so a failed or cancelled update
// leaves nothing behind; if the process is killed before, the copy stays as a tree with the points of the original.
// Not thread safe.
class UpdateTarget {
public:
    // Throws Error(invalid_argument) when neither or both are chosen, Error(exists) when something of the copy's name
    // exists, and what Tree::open and the file system throw.
    UpdateTarget(const std::filesystem::path& tree, const TargetChoice& choice);
    ~UpdateTarget();
    UpdateTarget(const UpdateTarget&) = delete;
    UpdateTarget& operator=(const UpdateTarget&) = delete;

    const std::filesystem::path& path() const { return path_; }
    bool is_copy() const { return is_copy_; }
    // The update has succeeded: the destructor leaves a copy where it is. Returns what is to be added to the warnings
    // of its outcome.
    const std::vector<std::string>& keep()
    {
        kept_ = true;
        return outcome_.warnings;
    }

private:
    std::filesystem::path path_;
    Outcome outcome_;  // of copying
    bool is_copy_ = false, kept_ = false;
};

}  // namespace pcm
