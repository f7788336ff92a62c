#include "pcm/system/output_group.h"

#include "pcm/system/error.h"
#include "pcm/system/part_file.h"

#include <memory>
#include <system_error>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

OutputGroup*& group_of_thread()
{
    static thread_local OutputGroup* group = nullptr;
    return group;
}

// Another name for the file `place`, under which it can be put back.
fs::path keep_earlier(const fs::path& place)
{
    const fs::path earlier = new_part_name(place);
    std::error_code error;
    fs::create_hard_link(place, earlier, error);
    if (!error) return earlier;
    fs::copy_file(place, earlier, error);  // the file system has no hard links
    if (!error) return earlier;
    const Error failure = Error::from_errno(error.value(), place, "keeping the earlier file");
    fs::remove(earlier, error);
    throw failure;
}

}  // namespace

OutputGroup::OutputGroup()
{
    if (group_of_thread()) throw Error(ErrorCode::invalid_argument, {}, "two groups of outputs in one thread");
    group_of_thread() = this;
}

OutputGroup::~OutputGroup()
{
    if (group_of_thread() == this) group_of_thread() = nullptr;
    std::error_code ignored;
    for (const Member& member : members_) {
        if (!member.part.empty()) fs::remove(member.part, ignored);
        if (!member.earlier.empty()) fs::remove(member.earlier, ignored);
    }
}

OutputGroup* OutputGroup::current() { return group_of_thread(); }

void OutputGroup::add(const fs::path& path, const fs::path& place, const fs::path& part, File& file)
{
    for (const Member& member : members_)
        if (member.place.lexically_normal() == place.lexically_normal())
            throw Error(ErrorCode::invalid_argument, path, "two outputs have this name", "choose different names");
    Member& member = members_.emplace_back();
    member.path = path;
    member.place = place;
    member.part = part;
    member.file = std::move(file);
}

void OutputGroup::place(Member& member)
{
    std::error_code error;
    if (members_.size() > 1 && fs::exists(fs::symlink_status(member.place, error)))
        member.earlier = keep_earlier(member.place);
    rename_path(member.part, member.place, "putting the finished file in place");
    member.part.clear();
    member.placed = true;
}

void OutputGroup::undo()
{
    std::error_code ignored;
    for (Member& member : members_) {
        if (!member.placed) continue;
        if (member.earlier.empty())
            fs::remove(member.place, ignored);
        else
            fs::rename(member.earlier, member.place, ignored);
        member.earlier.clear();  // what could not be put back keeps this name
    }
}

void OutputGroup::put_in_place()
{
    group_of_thread() = nullptr;
    std::vector<std::unique_ptr<OpenFolder>> folders;
    for (const Member& member : members_) folders.push_back(std::make_unique<OpenFolder>(folder_holding(member.place)));
    // What needs space comes first.
    for (Member& member : members_)
        if (member.part.empty()) member.part = name_part(member.file, member.place);
    try {
        for (Member& member : members_) place(member);
    } catch (...) {
        undo();
        throw;
    }
    for (Member& member : members_) {
        std::error_code error;
        if (!member.earlier.empty()) fs::remove(member.earlier, error);
        if (!error) member.earlier.clear();  // else the destructor tries again, and then the next output of this name
    }
    for (std::size_t i = 0; i < members_.size(); ++i) {
        try {
            folders[i]->sync();
            members_[i].file.close();
        } catch (const Error& error) {
            throw Error::after(members_[i].path, "the file is complete and in place", error);
        }
    }
}

}  // namespace pcm
