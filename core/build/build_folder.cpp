#include "pcm/build/build_folder.h"

#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/system/file_lock.h"
#include "pcm/system/output_path.h"
#include "pcm/system/tree_folder.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/unfinished_build.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>
#include <stdexcept>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr const char* publishing_name = "publishing";

bool is_there(const fs::path& path)
{
    std::error_code error;
    return fs::exists(fs::symlink_status(path, error));
}

// Not a link to one.
bool is_folder(const fs::path& path)
{
    std::error_code error;
    return fs::is_directory(fs::symlink_status(path, error));
}

std::optional<std::uint64_t> checksum_of_index(const fs::path& path)
{
    try {
        const std::vector<std::byte> bytes = read_index(File(path, File::Mode::read));
        return checksum(bytes.data(), bytes.size());
    } catch (const Error&) {
        return std::nullopt;
    }
}

// Exchanges the two atomically. False where the system cannot.
bool exchange(const fs::path& a, const fs::path& b)
{
    struct stat before {
    }, after{};
    const bool known = ::lstat(a.c_str(), &before) == 0;
    if (::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0) return true;
    const int error = errno;
    if (error == ENOSYS || error == EINVAL || error == EOPNOTSUPP) return false;
    // Network file systems may report a failure of what they have done.
    if (known && ::lstat(b.c_str(), &after) == 0 && before.st_ino == after.st_ino && before.st_dev == after.st_dev)
        return true;
    throw Error::from_errno(error, b, "putting the finished tree in the place of the old one");
}

// Another build may have the folder.
[[noreturn]] void refuse(FileLock lock, const fs::path& output, const fs::path& part)
{
    if (lock == FileLock::held)
        throw Error(ErrorCode::exists, output, "another build is writing this tree at this moment");
    throw Error(ErrorCode::exists, part,
                "this was left by an interrupted build, or one is running: the file system has no locks, which would "
                "distinguish the two",
                "remove the folder if no program is writing " + output.string());
}

}  // namespace

void check_place_of_tree(const fs::path& output, bool overwrite)
{
    const fs::path place = output_tree(output);
    if (!is_there(place)) return;
    if (!overwrite)
        throw Error(ErrorCode::exists, place, "there is something of this name already",
                    is_tree(place) ? "choose another name or overwrite it" : "choose another name");
    check_replaceable_tree(place);
}

BuildFolder::BuildFolder(const fs::path& output, bool overwrite, Builders builders)
    : of_a_team_(builders == Builders::a_team), output_(output_tree(output)), part_(build_folder_of(output_))
{
    std::error_code error;
    const fs::path parent = folder_holding(output_);
    if (!fs::is_directory(parent, error))
        throw Error(ErrorCode::not_found, parent, "no such folder to put the tree in");
    if (is_there(part_)) {
        lock(false);
        settle();
    }
    try {
        check_place_of_tree(output_, overwrite);
    } catch (...) {
        if (lock_.is_open() && !left_over_) remove_quietly();
        throw;
    }
    if (!lock_.is_open()) {
        const bool made = fs::create_directory(part_, error);
        if (!made && error) throw Error::from_errno(error.value(), part_, "creating the folder");
        lock(made);
    }
    try {
        if (!left_over_) clear();
    } catch (...) {
        remove_quietly();
        throw;
    }
    owned_ = true;
}

// `made`: this process has just made the folder.
void BuildFolder::lock(bool made)
{
    std::error_code error;
    for (;;) {
        if (is_there(part_) && !is_folder(part_))
            throw Error(ErrorCode::exists, part_,
                        "something of this name is in the way that is not a folder of a build", "remove or rename it");
        if (!is_there(part_ / build_marker_name) && !fs::is_empty(part_, error))
            throw Error(ErrorCode::exists, part_, "a folder of this name is in the way and is not an interrupted build",
                        "remove or rename it");
        lock_ = File(part_ / build_marker_name, File::Mode::change_or_create);
        const FileLock lock = take_lock(lock_.descriptor(), lock_.path());
        locked_ = lock == FileLock::taken;
        if (!locked_ && (lock == FileLock::held || !(made || of_a_team_))) refuse(lock, output_, part_);
        // One that has just ended may have removed what was opened here.
        struct stat opened {
        }, named{};
        if (::fstat(lock_.descriptor(), &opened) == 0 && ::stat((part_ / build_marker_name).c_str(), &named) == 0 &&
            opened.st_ino == named.st_ino && opened.st_dev == named.st_dev)
            break;
        made = fs::create_directory(part_, error);
        if (!made && error) throw Error::from_errno(error.value(), part_, "creating the folder");
    }
}

std::string BuildFolder::note() const
{
    if (locked_ || of_a_team_) return {};
    return "the file system has no locks: had this been interrupted, " + part_.string() + " would have to be removed";
}

// Puts back a tree that was being replaced, and removes what a finished build has left.
void BuildFolder::settle()
{
    if (is_folder(part_ / replaced_tree_name) && !is_there(output_)) {
        rename_path(part_ / replaced_tree_name, output_, "putting back the tree that was being replaced");
        sync_folder(folder_holding(output_));
    }
    if (is_there(part_ / publishing_name)) {
        std::uint64_t published = 0;
        const File file(part_ / publishing_name, File::Mode::read);
        if (file.read_some_at(&published, sizeof published, 0) == sizeof published &&
            checksum_of_index(output_ / index_file_name) == published)
            remove_all_but_marker();
    }
    left_over_ = std::distance(fs::directory_iterator(part_), fs::directory_iterator()) > 1;
    if (left_over_ && !is_folder(tree())) {
        remove_all_but_marker();
        left_over_ = false;
    }
}

BuildFolder::~BuildFolder()
{
    if (owned_ && !of_a_team_) remove_quietly();
}

// What cannot be removed now, the next build of this name removes.
std::string BuildFolder::remove_quietly()
{
    std::string why;
    for (int tries = 0; tries < 2; ++tries) {
        try {
            remove();
            return {};
        } catch (const std::exception& error) {
            why = error.what();
        }
    }
    return why;
}

void BuildFolder::remove_all_but_marker()
{
    for (const auto& entry : fs::directory_iterator(part_))
        if (entry.path().filename() != build_marker_name && entry.path().filename() != publishing_name)
            fs::remove_all(entry.path());
    fs::remove(part_ / publishing_name);  // last: it says that the rest is not needed
}

// The marker last: without it, the remains would not be recognized as a build's.
void BuildFolder::remove()
{
    remove_all_but_marker();
    fs::remove(part_ / build_marker_name);
    lock_ = File();
    fs::remove(part_);
}

void BuildFolder::discard()
{
    owned_ = false;
    remove();
}

void BuildFolder::clear()
{
    remove_all_but_marker();
    std::error_code error;
    if (!fs::create_directory(tree(), error)) throw Error::from_errno(error.value(), tree(), "creating the folder");
    left_over_ = false;
}

void BuildFolder::publish()
{
    const std::optional<std::uint64_t> index = checksum_of_index(tree() / index_file_name);
    if (!index) throw Error(ErrorCode::io, tree() / index_file_name, "the index cannot be read back");
    Tree::open(tree());  // what cannot be opened does not get the name
    sync_folder(tree());
    replace_file(part_ / publishing_name, &*index, sizeof *index);
    const OpenFolder parent(folder_holding(output_));
    const bool replaces = is_there(output_);
    if (!replaces)
        rename_path(tree(), output_, "giving the finished tree its name");
    else if (!exchange(tree(), output_))
        replace_in_two_steps();
    owned_ = false;
    try {
        parent.sync();
    } catch (const Error& error) {
        // After a loss of power the name may still be the old tree's: it is not removed.
        if (!replaces) remove_quietly();
        throw Error::after(output_,
                           replaces ? "the new tree is complete and in place, and the old one is kept in " +
                                          part_.string() + " until the next build of this name"
                                    : "the tree is complete and in place",
                           error);
    }
    if (const std::string left = remove_quietly(); !left.empty())
        throw Error::after(
            output_, "the tree is complete and in place",
            std::runtime_error("remains of its build in " + part_.string() + " could not be removed: " + left));
}

// Where the system cannot exchange two folders. After a failure the old tree has its name again, or is left for the
// next build to put back.
void BuildFolder::replace_in_two_steps()
{
    const fs::path old = part_ / replaced_tree_name;
    rename_path(output_, old, "moving the old tree out of the way");
    try {
        sync_folder(part_);
        rename_path(tree(), output_, "giving the finished tree its name");
    } catch (...) {
        if (std::rename(old.c_str(), output_.c_str()) != 0) owned_ = false;
        throw;
    }
}

bool put_back_replaced(const fs::path& output)
{
    if (!was_being_replaced(output)) return false;
    const fs::path part = build_folder_of(output);
    const File lock(part / build_marker_name, File::Mode::change_or_create);
    if (const FileLock state = take_lock(lock.descriptor(), lock.path()); state != FileLock::taken)
        refuse(state, output, part);
    if (!was_being_replaced(output)) return false;
    rename_path(part / replaced_tree_name, output, "putting back the tree that was being replaced");
    sync_folder(folder_holding(output));
    return true;
}

}  // namespace pcm
