#include "pcm/cluster/team_folder.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/tree/unfinished_build.h"

#include <string>
#include <system_error>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr const char* jobs_name = "jobs";
constexpr JobFolder::Key work_job{"build"};  // its record: the identity

}  // namespace

TeamFolder::TeamFolder(Team& team, const fs::path& output, bool overwrite, const std::vector<std::byte>& identity,
                       bool resume)
{
    if (team.broadcast(0, identity) != identity)
        throw Error(ErrorCode::invalid_argument, {},
                    "rank " + std::to_string(team.rank()) +
                        " sees other input files, or has other options, than rank 0: paths, sizes, times and options "
                        "have to be the same everywhere",
                    "give paths of a folder that all machines share");
    if (team.rank() == 0) take(output, overwrite, identity, resume);
    ByteWriter out;
    out.put_string(path_.string());
    const Team::Bytes bytes = team.broadcast(0, std::move(out.bytes()));
    ByteReader in(bytes.data(), bytes.size(), output);
    path_ = in.get_string();
    jobs_.emplace(path_ / jobs_name, team.rank(), resume);
}

// Rank 0 takes the folder, and removes other work.
void TeamFolder::take(const fs::path& output, bool overwrite, const std::vector<std::byte>& identity, bool resume)
{
    build_.emplace(output, overwrite, Builders::a_team);
    path_ = build_->work();
    const JobFolder jobs(path_ / jobs_name, 0, resume);
    if (build_->left_over()) {
        if (resume && jobs.is_done(work_job) && jobs.record(work_job) == identity) {
            found_ = Found::same_work;
            jobs.remove_unfinished();
        } else {
            found_ = Found::other_work;
            build_->clear();
        }
    }
    jobs.begin(work_job.stage);
    if (!jobs.is_done(work_job)) jobs.write(work_job, {}, identity);
}

bool was_begun_by_team(const fs::path& output)
{
    std::error_code error;
    return fs::exists(build_folder_of(output_tree(output)) / jobs_name, error);
}

}  // namespace pcm
