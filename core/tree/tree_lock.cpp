#include "pcm/tree/tree_lock.h"

#include "pcm/system/error.h"

#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>

namespace pcm {

TreeLock::TreeLock(const std::filesystem::path& folder)
{
    const std::filesystem::path path = folder / lock_file_name;
    for (;;) {
        file_ = File(path, File::Mode::change_or_create);
        while (::flock(file_.descriptor(), LOCK_EX | LOCK_NB) != 0) {
            if (errno == EINTR) continue;
            if (errno != EWOULDBLOCK) throw Error::from_errno(errno, path, "locking");
            throw Error(ErrorCode::exists, folder, "another process or thread is changing this tree",
                        "try again when it has finished");
        }
        // Compacting puts another folder in the tree's place: then this is the lock file of the removed folder.
        struct stat locked {
        }, named{};
        if (::fstat(file_.descriptor(), &locked) != 0)
            throw Error::from_errno(errno, path, "reading the properties of");
        if (::stat(path.c_str(), &named) == 0 && locked.st_dev == named.st_dev && locked.st_ino == named.st_ino) return;
    }
}

}  // namespace pcm
