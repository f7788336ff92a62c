#include "pcm/build/build_folder.h"

#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/unfinished_build.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr const char* publishing_name = "publishing";

fs::path parent_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

bool is_there(const fs::path& path)
{
    std::error_code error;
    return fs::exists(fs::symlink_status(path, error));
}

std::optional<std::uint64_t> checksum_of_file(const fs::path& path)
{
    try {
        const File file(path, File::Mode::read);
        std::vector<std::byte> bytes(file.size());
        file.read_at(bytes.data(), bytes.size(), 0);
        return checksum(bytes.data(), bytes.size());
    } catch (const Error&) {
        return std::nullopt;
    }
}

void rename(const fs::path& from, const fs::path& to, const char* action)
{
    if (std::rename(from.c_str(), to.c_str()) != 0) throw Error::from_errno(errno, to, action);
}

// Exchanges the two atomically. False where the system cannot.
bool exchange(const fs::path& a, const fs::path& b)
{
    if (::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0) return true;
    if (errno == ENOSYS || errno == EINVAL || errno == EOPNOTSUPP) return false;
    throw Error::from_errno(errno, b, "putting the finished tree in the place of the old one");
}

}  // namespace

BuildFolder::BuildFolder(const fs::path& output, bool overwrite) : output_(output), part_(build_folder_of(output))
{
    std::error_code error;
    const fs::path parent = parent_of(output_);
    if (!fs::is_directory(parent, error))
        throw Error(ErrorCode::not_found, parent, "no such folder to put the tree in");
    if (is_there(part_)) {
        lock();
        settle();
    }
    if (is_there(output_)) {
        const bool is_a_tree = is_tree(output_);
        if (!overwrite || !is_a_tree) {
            if (lock_.is_open() && !left_over_) remove_quietly();
            if (overwrite)
                throw Error(ErrorCode::exists, output_, "this is not a point cloud tree, so it is not overwritten");
            throw Error(ErrorCode::exists, output_, "there is something of this name already",
                        is_a_tree ? "choose another name or overwrite it" : "choose another name");
        }
    }
    if (!lock_.is_open()) {
        if (!fs::create_directory(part_, error) && error)
            throw Error::from_errno(error.value(), part_, "creating the folder");
        lock();
    }
    try {
        if (!left_over_) clear();
    } catch (...) {
        remove_quietly();
        throw;
    }
    owned_ = true;
}

void BuildFolder::lock()
{
    std::error_code error;
    for (;;) {
        if (!fs::exists(part_ / build_marker_name, error) && !fs::is_empty(part_, error))
            throw Error(ErrorCode::exists, part_, "a folder of this name is in the way and is not an interrupted build",
                        "remove or rename it");
        lock_ = File(part_ / build_marker_name, File::Mode::create_or_truncate);
        if (::flock(lock_.descriptor(), LOCK_EX | LOCK_NB) != 0)
            throw Error(ErrorCode::exists, output_, "another build is writing this tree at this moment");
        // One that has just ended may have removed what was opened here.
        struct stat opened {
        }, named{};
        if (::fstat(lock_.descriptor(), &opened) == 0 && ::stat((part_ / build_marker_name).c_str(), &named) == 0 &&
            opened.st_ino == named.st_ino && opened.st_dev == named.st_dev)
            break;
        if (!is_there(part_) && !fs::create_directory(part_, error))
            throw Error::from_errno(error.value(), part_, "creating the folder");
    }
}

// Puts back a tree that was being replaced, and removes what a finished build has left.
void BuildFolder::settle()
{
    if (is_there(part_ / replaced_tree_name) && !is_there(output_)) {
        rename(part_ / replaced_tree_name, output_, "putting back the tree that was being replaced");
        sync_folder(parent_of(output_));
    }
    if (is_there(part_ / publishing_name)) {
        std::uint64_t published = 0;
        const File file(part_ / publishing_name, File::Mode::read);
        if (file.read_some_at(&published, sizeof published, 0) == sizeof published &&
            checksum_of_file(output_ / index_file_name) == published)
            remove_all_but_marker();
    }
    left_over_ = std::distance(fs::directory_iterator(part_), fs::directory_iterator()) > 1;
    std::error_code error;
    if (left_over_ && !fs::is_directory(tree(), error)) {
        remove_all_but_marker();
        left_over_ = false;
    }
}

BuildFolder::~BuildFolder()
{
    if (owned_) remove_quietly();
}

// What cannot be removed now, the next build of this name removes.
void BuildFolder::remove_quietly()
{
    for (int tries = 0; tries < 2; ++tries) {
        try {
            return remove();
        } catch (const std::exception&) {
        }
    }
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

void BuildFolder::clear()
{
    remove_all_but_marker();
    std::error_code error;
    if (!fs::create_directory(tree(), error)) throw Error::from_errno(error.value(), tree(), "creating the folder");
    left_over_ = false;
}

void BuildFolder::publish()
{
    const std::optional<std::uint64_t> index = checksum_of_file(tree() / index_file_name);
    if (!index) throw Error(ErrorCode::io, tree() / index_file_name, "the index cannot be read back");
    Tree::open(tree());  // what cannot be opened does not get the name
    sync_folder(tree());
    replace_file(part_ / publishing_name, &*index, sizeof *index);
    // Until the new name is on disk for good, a failure undoes what was done.
    if (!is_there(output_)) {
        rename(tree(), output_, "giving the finished tree its name");
        try {
            sync_folder(parent_of(output_));
        } catch (...) {
            std::rename(output_.c_str(), tree().c_str());
            throw;
        }
    } else if (exchange(tree(), output_)) {
        try {
            sync_folder(parent_of(output_));
        } catch (...) {
            exchange(tree(), output_);
            throw;
        }
    } else {
        rename(output_, part_ / replaced_tree_name, "moving the old tree out of the way");
        try {
            sync_folder(part_);
            rename(tree(), output_, "giving the finished tree its name");
        } catch (...) {
            std::rename((part_ / replaced_tree_name).c_str(), output_.c_str());
            throw;
        }
        sync_folder(parent_of(output_));
    }
    owned_ = false;
    remove_quietly();
}

bool put_back_replaced(const fs::path& output)
{
    if (!was_being_replaced(output)) return false;
    const fs::path part = build_folder_of(output);
    const File lock(part / build_marker_name, File::Mode::create_or_truncate);
    if (::flock(lock.descriptor(), LOCK_EX | LOCK_NB) != 0)
        throw Error(ErrorCode::exists, output, "a build is writing this tree at this moment");
    if (!was_being_replaced(output)) return false;
    rename(part / replaced_tree_name, output, "putting back the tree that was being replaced");
    sync_folder(parent_of(output));
    return true;
}

}  // namespace pcm
