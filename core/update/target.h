// Where the result of an update goes: into the tree itself, or into a copy of it.
#pragma once

#include "pcm/system/progress.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace pcm {

class BuildFolder;

// The user's choice. Exactly one of the two must be made, so that no tree is changed by an option left out.
struct TargetChoice {
    std::filesystem::path copy;  // folder of the tree to write; empty: no copy
    bool in_place = false;       // change the tree itself
    bool overwrite = false;      // replace `copy` if it is a tree, or a file where one can be written
};

// Throws Error(invalid_argument) unless exactly one of the two is chosen.
void check_choice(const std::filesystem::path& tree, const TargetChoice& choice);
// Throws Error(invalid_argument) where the copy is the tree itself, `folder`.
void refuse_own_copy(const std::filesystem::path& folder, const TargetChoice& choice);

// Throws what UpdateTarget() would throw: for what refuses a target before the work that leads to the update.
void check_target(const std::filesystem::path& tree, const TargetChoice& choice);

// The tree that an update (append_points, erase_points, TreeChanges) is to change:
//
//     UpdateTarget target(tree, choice);
//     const AppendReport report =
//         target.update([&](const auto& folder) { return append_points(folder, cloud, names); });
//
// A copy is made by the constructor, in the working folder of a build of its name (build/build_folder.h), and changed
// there; update() gives it its name when the work is done, in place of a tree that is replaced. Whatever ends the
// process before, there is no tree of that name: the next build or copy of the name removes the remains. It shares the
// data files of the original where the file system has hard links, so it takes little time and space. The destructor
// removes a copy that has no name yet. Not thread safe.
class UpdateTarget {
public:
    // Throws Error(invalid_argument) when neither or both are chosen or the copy is to replace the tree itself,
    // Error(exists) when something of the copy's name exists that is not to be replaced or cannot be, or is being
    // written, and what Tree::open and the file system throw.
    UpdateTarget(const std::filesystem::path& tree, const TargetChoice& choice);
    ~UpdateTarget();
    UpdateTarget(const UpdateTarget&) = delete;
    UpdateTarget& operator=(const UpdateTarget&) = delete;

    // The tree itself, or the copy, which exists after update().
    const std::filesystem::path& path() const { return path_; }
    bool is_copy() const { return is_copy_; }

    // Calls `work(folder)`, which changes the tree in that folder, leaves nothing of it open and returns a report with
    // an Outcome `outcome`. Then a copy gets its name; what fails after that is a warning of the outcome. Errors and
    // warnings name the original or the copy in place of the working folder. Once.
    template <class Work>
    auto update(const Work& work)
    {
        std::optional<decltype(work(path_))> report;
        run([&](const std::filesystem::path& folder) -> Outcome& { return report.emplace(work(folder)).outcome; });
        return std::move(*report);
    }

private:
    void run(const std::function<Outcome&(const std::filesystem::path& folder)>& work);

    std::filesystem::path tree_, path_;
    bool is_copy_ = false;
    std::unique_ptr<BuildFolder> made_;  // folder of the copy
};

}  // namespace pcm
