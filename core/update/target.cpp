#include "pcm/update/target.h"

#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/update/clone.h"

#include <system_error>

namespace pcm {

UpdateTarget::UpdateTarget(const std::filesystem::path& tree, const TargetChoice& choice)
    : path_(choice.in_place ? tree : choice.copy), is_copy_(!choice.in_place)
{
    if (choice.in_place && !choice.copy.empty())
        throw Error(ErrorCode::invalid_argument, tree,
                    "is to be changed in place, and an output (" + choice.copy.string() + ") is given too",
                    "choose one of the two");
    if (!is_copy_) return;
    if (choice.copy.empty())
        throw Error(ErrorCode::invalid_argument, tree, "no output is given, and the tree is not to be changed in place",
                    "name the tree to write, or choose to change this one in place");
    output_tree(path_);
    run_last_step(outcome_, [&] { clone_tree(tree, path_); });
}

UpdateTarget::~UpdateTarget()
{
    std::error_code ignored;
    if (is_copy_ && !kept_) std::filesystem::remove_all(path_, ignored);
}

}  // namespace pcm
