// The folder in which a team works on a tree, next to it, and the files of the team's jobs there.
#pragma once

#include "pcm/build/build_folder.h"
#include "pcm/cluster/job_folder.h"
#include "pcm/threads/team.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace pcm {

class TeamFolder {
public:
    enum class Found { nothing, same_work, other_work };

    // Collective. `identity`: bytes that differ for work whose jobs differ. Work that is left over is resumed
    // where its identity is this one and `resume`, else it is removed. Throws Error(invalid_argument) where the ranks
    // have not the same identity, and in rank 0 what BuildFolder throws.
    TeamFolder(Team& team, const std::filesystem::path& output, bool overwrite, const std::vector<std::byte>& identity,
               bool resume);

    Found found() const { return found_; }  // in rank 0
    const std::filesystem::path& path() const { return path_; }
    const JobFolder& jobs() const { return *jobs_; }
    BuildFolder& build() { return *build_; }  // in rank 0

private:
    void take(const std::filesystem::path& output, bool overwrite, const std::vector<std::byte>& identity, bool resume);

    std::optional<BuildFolder> build_;  // rank 0's
    std::filesystem::path path_;
    std::optional<JobFolder> jobs_;
    Found found_ = Found::nothing;
};

// Whether a team has begun to work in the folder of this tree.
bool was_begun_by_team(const std::filesystem::path& output);

}  // namespace pcm
