#include "tree/build_folder.h"

#include "cloud/error.h"
#include "tree/tree.h"
#include "tree/tree_index.h"

#include <sys/file.h>

#include <cerrno>
#include <cstdio>

namespace pcm {

namespace fs = std::filesystem;

BuildFolder::BuildFolder(const fs::path& output, bool overwrite) : output_(output), part_(output)
{
    part_ += ".part";
    std::error_code error;
    if (fs::exists(fs::symlink_status(output_, error))) {
        if (!overwrite)
            throw Error(ErrorCode::exists, output_, "there is something of this name already",
                        is_tree(output_) ? "choose another name or overwrite it" : "choose another name");
        if (!is_tree(output_))
            throw Error(ErrorCode::exists, output_, "this is not a point cloud tree, so it is not overwritten");
    }
    const fs::path parent = output_.has_parent_path() ? output_.parent_path() : fs::path(".");
    if (!fs::is_directory(parent, error))
        throw Error(ErrorCode::not_found, parent, "no such folder to put the tree in");
    const bool left_over = fs::exists(part_, error);
    if (left_over && !fs::exists(part_ / build_marker_name, error) && !fs::is_empty(part_, error))
        throw Error(ErrorCode::exists, part_, "a folder of this name is in the way and is not an interrupted build",
                    "remove or rename it");
    if (!left_over && !fs::create_directory(part_, error)) throw Error::from_errno(error.value(), part_, "creating the folder");
    lock_ = File(part_ / build_marker_name, File::Mode::create_or_truncate);
    if (::flock(lock_.descriptor(), LOCK_EX | LOCK_NB) != 0)
        throw Error(ErrorCode::exists, output_, "another build is writing this tree at this moment");
    owned_ = true;
    // What an interrupted build has left is never looked at.
    for (const auto& entry : fs::directory_iterator(part_))
        if (entry.path().filename() != build_marker_name) fs::remove_all(entry.path());
}

BuildFolder::~BuildFolder()
{
    std::error_code ignored;
    if (owned_) fs::remove_all(part_, ignored);
}

void BuildFolder::publish()
{
    fs::remove(part_ / build_marker_name);
    sync_folder(part_);
    std::error_code error;
    fs::path old;
    if (fs::exists(output_, error)) {
        old = output_;
        old += ".old";
        fs::remove_all(old);
        fs::rename(output_, old);
    }
    if (std::rename(part_.c_str(), output_.c_str()) != 0) {
        const int number = errno;
        if (!old.empty()) fs::rename(old, output_, error);
        throw Error::from_errno(number, output_, "giving the finished tree its name");
    }
    owned_ = false;
    sync_folder(output_.has_parent_path() ? output_.parent_path() : fs::path("."));
    if (!old.empty()) fs::remove_all(old, error);
}

}  // namespace pcm
