#include "pcm/cluster/team_verify.h"

#include "pcm/cluster/rank_error.h"
#include "pcm/cluster/team_work.h"

namespace pcm {

VerifyReport verify_tree_by(Team& team, const std::filesystem::path& tree, unsigned threads,
                            const ProgressFunction& progress)
{
    return named_by_rank(team, tree, [&] { return verify_tree(tree, threads, progress, team, count_chunks); });
}

}  // namespace pcm
