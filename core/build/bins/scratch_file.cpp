#include "pcm/build/bins/scratch_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>

namespace pcm {

Error scratch_changed(const std::filesystem::path& path, std::uint64_t offset)
{
    return Error(ErrorCode::corrupt, path,
                 "the data at byte " + std::to_string(offset) + " have changed since they were written",
                 "the disk may be failing; build again");
}

ScratchFile::ScratchFile(const std::filesystem::path& path, ScratchSpace& space, bool reopen)
    : file_(path, reopen ? File::Mode::change : File::Mode::create_or_truncate), space_(space), end_(file_.size())
{
    struct stat status {};
    if (::fstat(file_.descriptor(), &status) != 0) throw Error::from_errno(errno, path, "reading the size");
    take(static_cast<std::uint64_t>(status.st_blocks) * 512);
}

ScratchFile::~ScratchFile() { space_.give_back(on_disk_); }

void ScratchFile::take(std::uint64_t bytes)
{
    on_disk_ += bytes;
    space_.take(bytes);
}

void ScratchFile::give_back(std::uint64_t offset, std::uint64_t length, std::uint64_t bytes)
{
    if (length == 0) return;
    int result;
    do
        result = ::fallocate(file_.descriptor(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset),
                             static_cast<off_t>(length));
    while (result != 0 && errno == EINTR);
    if (result != 0) return;  // not supported by every file system; costs space only
    on_disk_ -= bytes;
    space_.give_back(bytes);
}

void ScratchFile::clear()
{
    if (::ftruncate(file_.descriptor(), 0) != 0) return;  // costs space only
    space_.give_back(on_disk_.exchange(0));
}

void ScratchFile::remove()
{
    const std::filesystem::path path = file_.path();
    file_ = File();
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    space_.give_back(on_disk_.exchange(0));
}

}  // namespace pcm
