#include "tree/scratch_file.h"

#include "cloud/error.h"

#include <fcntl.h>

#include <cerrno>

namespace pcm {

ScratchFile::ScratchFile(const std::filesystem::path& path, ScratchSpace& space)
    : file_(path, File::Mode::create_new), space_(space)
{
}

ScratchFile::ScratchFile(const std::filesystem::path& path, ScratchSpace& space, std::uint64_t bytes, std::uint64_t on_disk)
    : file_(path, File::Mode::change), space_(space), end_(bytes)
{
    if (file_.size() < bytes)
        throw Error(ErrorCode::truncated, path,
                    "the file has " + std::to_string(file_.size()) + " bytes, " + std::to_string(bytes) + " were expected");
    take(on_disk);
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
    do result = ::fallocate(file_.descriptor(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset),
                            static_cast<off_t>(length));
    while (result != 0 && errno == EINTR);
    if (result != 0) {
        if (errno == EOPNOTSUPP || errno == ENOSYS || errno == EINVAL) return;
        throw Error::from_errno(errno, file_.path(), "giving space back");
    }
    on_disk_ -= bytes;
    space_.give_back(bytes);
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
