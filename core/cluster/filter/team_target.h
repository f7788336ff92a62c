// The tree that a team's filter changes: the tree itself or a copy, which rank 0 makes when the others' work is done.
#pragma once

#include "pcm/cluster/team_folder.h"
#include "pcm/system/progress.h"
#include "pcm/tree/tree.h"
#include "pcm/update/target.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pcm {

class TeamTarget {
public:
    // Collective. `choice` without a copy: the jobs' folder is next to the tree. `options`: bytes that differ for work
    // whose jobs differ. Throws what UpdateTarget (update/target.h) and TeamFolder throw.
    TeamTarget(Team& team, const std::filesystem::path& tree, const TargetChoice& choice,
               const std::vector<std::byte>& options);

    const std::shared_ptr<const Tree>& tree() const { return tree_; }  // as it is before the work
    const JobFolder& jobs() const { return folder_->jobs(); }
    const std::filesystem::path& scratch() const { return folder_->path(); }

    // Throws Error(exists) unless `now` is the tree that the jobs are of.
    void refuse_changed(const Tree& now) const;

    // In rank 0: calls `work(folder)`, which changes the tree in that folder, leaves nothing of it open and returns its
    // report's outcome. Then a copy gets its name, and the jobs' folder is removed; what fails after the tree is
    // changed is a warning of the outcome. After an error the folder stays for the next try. Once.
    void change(const std::function<Outcome&(const std::filesystem::path& folder)>& work);
    // For what changes nothing: the jobs' folder is removed.
    void end(Outcome& outcome);

    std::vector<std::string> notes() const;  // in rank 0

private:
    void change_copy(const std::function<Outcome&(const std::filesystem::path& folder)>& work);

    const std::filesystem::path copy_;
    std::shared_ptr<const Tree> tree_;
    std::unique_ptr<TeamFolder> folder_;
};

}  // namespace pcm
