#include "pcm/tree/tree_lock.h"

#include "pcm/system/error.h"
#include "pcm/system/file_lock.h"
#include "pcm/system/url.h"

#include <sys/stat.h>

#include <cerrno>

namespace pcm {
namespace {

// The folder of a build belongs to the process that makes the tree in it (build/build_folder.h), with or without locks.
bool is_in_build(const std::filesystem::path& folder)
{
    std::error_code ignored;
    return folder.parent_path().extension() == ".part" &&
           std::filesystem::exists(folder.parent_path() / build_marker_name, ignored);
}

}  // namespace

TreeLock::TreeLock(const std::filesystem::path& folder)
{
    refuse_to_write(folder);
    const std::filesystem::path path = folder / lock_file_name;
    for (;;) {
        file_ = File(path, File::Mode::change_or_create);
        const FileLock state = take_lock(file_.descriptor(), path);
        if (state == FileLock::held)
            throw Error(ErrorCode::exists, folder, "another process or thread is changing this tree",
                        "try again when it has finished");
        if (state == FileLock::impossible && !is_in_build(folder))
            throw Error(ErrorCode::unsupported, folder,
                        "the tree is not changed in place: the file system has no locks, which keep two programs from "
                        "changing it at the same time",
                        "write a copy, or change it on another file system");
        // Compacting puts another folder in the tree's place: then this is the lock file of the removed folder.
        struct stat locked {
        }, named{};
        if (::fstat(file_.descriptor(), &locked) != 0)
            throw Error::from_errno(errno, path, "reading the properties of");
        if (::stat(path.c_str(), &named) == 0 && locked.st_dev == named.st_dev && locked.st_ino == named.st_ino) return;
    }
}

}  // namespace pcm
