#include "pcm/cluster/filter/team_target.h"

#include "pcm/cluster/filter/tree_jobs.h"
#include "pcm/system/error.h"
#include "pcm/system/renamed_error.h"
#include "pcm/update/clone.h"

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t jobs_version = 1;  // to be raised when the same work's jobs get other files

std::vector<std::byte> identity_of(const Tree& tree, const std::vector<std::byte>& options)
{
    const TreeInfo& info = tree.info();
    ByteWriter out;
    out.put(jobs_version);
    std::error_code error;
    const fs::path real = fs::canonical(tree.folder(), error);
    out.put_string((error ? tree.folder() : real).string());
    put_state(out, info);
    out.put_bytes(options.data(), options.size());
    return std::move(out.bytes());
}

}  // namespace

TeamTarget::TeamTarget(Team& team, const fs::path& tree, const TargetChoice& choice,
                       const std::vector<std::byte>& options)
    : copy_(choice.copy), tree_(Tree::open(tree))
{
    const bool is_copy = !copy_.empty();
    if (is_copy) refuse_own_copy(tree_->folder(), choice);
    folder_ = std::make_unique<TeamFolder>(team, is_copy ? copy_ : tree_->folder(), !is_copy || choice.overwrite,
                                           identity_of(*tree_, options), true);
}

void TeamTarget::refuse_changed(const Tree& now) const
{
    const TreeInfo &before = tree_->info(), &info = now.info();
    if (info.generation == before.generation && info.content_hash == before.content_hash && info.bytes == before.bytes)
        return;
    throw tree_has_changed(tree_->folder());
}

void TeamTarget::change(const std::function<Outcome&(const fs::path& folder)>& work)
{
    if (!copy_.empty()) return change_copy(work);
    end(work(tree_->folder()));
}

void TeamTarget::end(Outcome& outcome)
{
    run_last_step(outcome, [this] {
        try {
            folder_->build().discard();
        } catch (const std::exception& error) {
            throw Error::after(folder_->path(), "the work is done, but this folder could not be removed", error);
        }
    });
}

void TeamTarget::change_copy(const std::function<Outcome&(const fs::path& folder)>& work)
{
    BuildFolder& build = folder_->build();
    const fs::path folder = build.tree();
    try {
        fs::remove_all(folder);  // remains of an earlier try
        fs::create_directory(folder);
        clone_into(tree_->folder(), folder);
        Outcome& outcome = work(folder);
        for (std::string& warning : outcome.warnings) warning = renamed(warning, folder, copy_);
        run_last_step(outcome, [&] { build.publish(); });
    } catch (const Error& error) {
        if (error.is_done()) throw;
        throw renamed(error, folder, copy_);
    }
}

std::vector<std::string> TeamTarget::notes() const
{
    if (folder_->found() == TeamFolder::Found::same_work) return {"interrupted work was resumed"};
    if (folder_->found() == TeamFolder::Found::other_work)
        return {"the remains of interrupted work on something else were removed"};
    return {};
}

}  // namespace pcm
