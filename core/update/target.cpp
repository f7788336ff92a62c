#include "pcm/update/target.h"

#include "pcm/build/build_folder.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/system/renamed_error.h"
#include "pcm/tree/tree.h"
#include "pcm/update/clone.h"

namespace pcm {
namespace {

namespace fs = std::filesystem;

// Writing concerns the copy. All else was found in the original, whose contents the copy has.
bool concerns_copy(ErrorCode code)
{
    return code == ErrorCode::no_space || code == ErrorCode::permission || code == ErrorCode::io ||
           code == ErrorCode::exists;
}

// The folder of the tree that is copied; empty for a change in place.
fs::path original_of(const fs::path& tree, const TargetChoice& choice)
{
    check_choice(tree, choice);
    if (choice.in_place) return {};
    output_tree(choice.copy);
    fs::path original = Tree::open(tree)->folder();  // what is wrong with the original comes first
    refuse_own_copy(original, choice);
    return original;
}

}  // namespace

void check_choice(const fs::path& tree, const TargetChoice& choice)
{
    if (choice.in_place && !choice.copy.empty())
        throw Error(ErrorCode::invalid_argument, tree,
                    "is to be changed in place, and an output (" + choice.copy.string() + ") is given too",
                    "choose one of the two");
    if (!choice.in_place && choice.copy.empty())
        throw Error(ErrorCode::invalid_argument, tree, "no output is given, and the tree is not to be changed in place",
                    "name the tree to write, or choose to change this one in place");
}

void refuse_own_copy(const fs::path& folder, const TargetChoice& choice)
{
    std::error_code ignored;
    if (fs::equivalent(folder, choice.copy, ignored))
        throw Error(ErrorCode::invalid_argument, choice.copy, "the output is the input tree",
                    "give the new tree another name, or change the tree in place");
}

void check_target(const fs::path& tree, const TargetChoice& choice)
{
    original_of(tree, choice);
    if (!choice.in_place) check_place_of_tree(choice.copy, choice.overwrite);
}

UpdateTarget::UpdateTarget(const fs::path& tree, const TargetChoice& choice)
    : tree_(tree), path_(choice.in_place ? tree : choice.copy), is_copy_(!choice.in_place)
{
    const fs::path original = original_of(tree, choice);
    if (!is_copy_) return;
    tree_ = original;
    made_ = std::make_unique<BuildFolder>(path_, choice.overwrite);
    if (made_->left_over()) made_->clear();
    try {
        clone_into(tree_, made_->tree());
    } catch (const Error& error) {
        throw renamed(error, made_->tree(), path_);
    }
}

UpdateTarget::~UpdateTarget() = default;

void UpdateTarget::run(const std::function<Outcome&(const fs::path& folder)>& work)
{
    if (!is_copy_) {
        work(path_);
        return;
    }
    const fs::path folder = made_->tree();
    try {
        Outcome& outcome = work(folder);
        for (std::string& warning : outcome.warnings) warning = renamed(warning, folder, path_);
        run_last_step(outcome, [this] { made_->publish(); });
    } catch (const Error& error) {
        throw renamed(error, folder, concerns_copy(error.code()) ? path_ : tree_);
    } catch (const fs::filesystem_error& error) {
        throw Error::from_errno(error.code().value(), renamed(error.path1().string(), folder, path_),
                                "working in the folder");
    }
}

}  // namespace pcm
