#include "pcm/system/file_lock.h"

#include "pcm/system/error.h"

#include <sys/file.h>

#include <cerrno>

namespace pcm {

FileLock take_lock(int descriptor, const std::filesystem::path& path)
{
    int result;
    do result = ::flock(descriptor, LOCK_EX | LOCK_NB);
    while (result != 0 && errno == EINTR);
    if (result == 0) return FileLock::taken;
    const int error = errno;
    if (error == EWOULDBLOCK) return FileLock::held;
    // Network and cluster file systems that are mounted without locks.
    if (error == ENOLCK || error == ENOSYS || error == ENOTSUP || error == EOPNOTSUPP) return FileLock::impossible;
    throw Error::from_errno(error, path, "locking");
}

}  // namespace pcm
