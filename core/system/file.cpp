#include "pcm/system/file.h"

#include "pcm/system/error.h"
#include "pcm/system/work_done.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

bool same_file(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

const char* name_of(mode_t mode)
{
    return S_ISDIR(mode)                    ? "a folder"
           : S_ISFIFO(mode)                 ? "a FIFO"
           : S_ISSOCK(mode)                 ? "a socket"
           : S_ISLNK(mode)                  ? "a symbolic link"
           : S_ISCHR(mode) || S_ISBLK(mode) ? "a device"
                                            : "not a regular file";
}

[[noreturn]] void refuse(const fs::path& path, mode_t mode)
{
    if (S_ISLNK(mode))
        throw Error(ErrorCode::unsupported, path,
                    "this is a symbolic link, and files are not written through links here", "remove the link");
    throw Error(ErrorCode::unsupported, path,
                std::string("this is ") + name_of(mode) + "; a regular file was expected");
}

// Before opening: to open a device can have effects, and a socket cannot be opened.
void refuse_what_is_no_file(const fs::path& path, bool follow)
{
    struct stat status {};
    if ((follow ? ::stat(path.c_str(), &status) : ::lstat(path.c_str(), &status)) == 0 && !S_ISREG(status.st_mode))
        refuse(path, status.st_mode);
}

int flags_of(File::Mode mode)
{
    switch (mode) {
        case File::Mode::read:
            return O_RDONLY;
        case File::Mode::change:
            return O_RDWR | O_NOFOLLOW;
        case File::Mode::change_or_create:
            return O_RDWR | O_NOFOLLOW | O_CREAT;
        default:
            return O_RDWR | O_NOFOLLOW | O_CREAT | O_EXCL;
    }
}

// O_NONBLOCK: should a FIFO have got the name meanwhile, opening it must not wait for its other end. A file that
// another program has leased (F_SETLEASE) can only be opened by waiting.
int open_descriptor(const fs::path& path, int flags)
{
    constexpr int always = O_CLOEXEC | O_NOCTTY;
    const int descriptor = ::open(path.c_str(), flags | always | O_NONBLOCK, 0666);
    if (descriptor >= 0 || errno != EWOULDBLOCK) return descriptor;
    refuse_what_is_no_file(path, true);
    return ::open(path.c_str(), flags | always, 0666);
}

}  // namespace

File::File(const std::filesystem::path& path, Mode mode) : path_(path)
{
    const bool existing = mode == Mode::read || mode == Mode::change;
    if (existing || mode == Mode::change_or_create) refuse_what_is_no_file(path, mode == Mode::read);
    descriptor_ = open_descriptor(path, flags_of(mode));
    if (descriptor_ < 0 && errno == EEXIST && mode == Mode::create_or_truncate) {
        if (::unlink(path.c_str()) != 0 && errno != ENOENT)
            throw Error::from_errno(errno, path, "removing the file that has the name");
        descriptor_ = open_descriptor(path, flags_of(mode));
    }
    if (descriptor_ < 0) throw Error::from_errno(errno, path, existing ? "opening" : "creating");
    struct stat status {};
    const bool known = ::fstat(descriptor_, &status) == 0;
    const int error = errno;
    if (known && S_ISREG(status.st_mode)) return;
    ::close(std::exchange(descriptor_, -1));
    if (!known) throw Error::from_errno(error, path, "reading the properties of");
    refuse(path, status.st_mode);
}

File::File(File&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)), path_(std::move(other.path_)) {}

File& File::operator=(File&& other) noexcept
{
    if (this != &other) {
        if (descriptor_ >= 0) ::close(descriptor_);
        descriptor_ = std::exchange(other.descriptor_, -1);
        path_ = std::move(other.path_);
    }
    return *this;
}

File::~File()
{
    if (descriptor_ >= 0) ::close(descriptor_);
}

std::uint64_t File::size() const
{
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) throw Error::from_errno(errno, path_, "reading the size");
    return static_cast<std::uint64_t>(status.st_size);
}

std::size_t File::read_some_at(void* to, std::size_t bytes, std::uint64_t offset) const
{
    std::size_t done = 0;
    while (done < bytes) {
        const ssize_t got =
            ::pread(descriptor_, static_cast<char*>(to) + done, bytes - done, static_cast<off_t>(offset + done));
        if (got < 0) {
            if (errno == EINTR) continue;
            throw Error::from_errno(errno, path_, "reading at byte " + std::to_string(offset + done));
        }
        if (got == 0) break;
        done += static_cast<std::size_t>(got);
    }
    count_read(done);
    return done;
}

void File::expect_scattered_reads() const
{
#ifdef POSIX_FADV_RANDOM
    ::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_RANDOM);
#endif
}

bool File::keeps_its_name() const
{
    struct stat opened {
    }, named{};
    return ::fstat(descriptor_, &opened) == 0 && ::stat(path_.c_str(), &named) == 0 && same_file(opened, named);
}

void File::write_at(const void* from, std::size_t bytes, std::uint64_t offset)
{
    std::size_t done = 0;
    while (done < bytes) {
        const ssize_t put = ::pwrite(descriptor_, static_cast<const char*>(from) + done, bytes - done,
                                     static_cast<off_t>(offset + done));
        if (put < 0) {
            if (errno == EINTR) continue;
            throw Error::from_errno(errno, path_, "writing at byte " + std::to_string(offset + done));
        }
        done += static_cast<std::size_t>(put);
    }
}

void File::sync()
{
    if (::fsync(descriptor_) != 0) throw Error::from_errno(errno, path_, "flushing to disk");
}

File File::without_name(const std::filesystem::path& path)
{
    File file;
    file.path_ = path;
    file.descriptor_ = ::open(folder_holding(path).c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
    const bool unsupported = errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL || errno == ENOSYS;
    if (file.descriptor_ < 0 && !unsupported) throw Error::from_errno(errno, path, "creating");
    return file;
}

bool File::give_name(const std::filesystem::path& path) const
{
    const std::string self = "/proc/self/fd/" + std::to_string(descriptor_);
    if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0) return true;
    const int error = errno;
    struct stat mine {
    }, named{};
    if (::fstat(descriptor_, &mine) == 0 && ::lstat(path.c_str(), &named) == 0 && same_file(mine, named)) return true;
    if (error == EEXIST) return false;
    if (error == ENOENT || error == EXDEV || error == EPERM || error == EINVAL || error == EOPNOTSUPP ||
        error == ENOSYS)
        throw Error(ErrorCode::unsupported, path, "the system cannot give a file without a name one");
    throw Error::from_errno(error, path, "giving the finished file its name");
}

void File::close()
{
    if (descriptor_ >= 0 && ::close(std::exchange(descriptor_, -1)) != 0)
        throw Error::from_errno(errno, path_, "closing");
}

OpenFolder::OpenFolder(const std::filesystem::path& folder)
    : path_(folder), descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC))
{
    if (descriptor_ < 0) throw Error::from_errno(errno, folder, "opening the folder");
}

OpenFolder::~OpenFolder() { ::close(descriptor_); }

void OpenFolder::sync() const
{
    // Some network file systems cannot sync a folder and return EINVAL; nothing more can be done there.
    if (::fsync(descriptor_) != 0 && errno != EINVAL)
        throw Error::from_errno(errno, path_, "flushing the folder to disk");
}

void sync_folder(const std::filesystem::path& folder) { OpenFolder(folder).sync(); }

std::filesystem::path folder_holding(const std::filesystem::path& path)
{
    return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

void rename_path(const std::filesystem::path& from, const std::filesystem::path& to, const std::string& action)
{
    struct stat before {
    }, gone{}, now{};
    const bool known = ::lstat(from.c_str(), &before) == 0;
    if (std::rename(from.c_str(), to.c_str()) == 0) return;
    const int error = errno;
    const bool done = known && ::lstat(from.c_str(), &gone) != 0 && errno == ENOENT && ::lstat(to.c_str(), &now) == 0 &&
                      same_file(before, now);
    if (!done) throw Error::from_errno(error, to, action);
}

void replace_file(const std::filesystem::path& path, const void* bytes, std::size_t size)
{
    std::filesystem::path temporary = path;
    temporary += ".new";
    try {
        File file(temporary, File::Mode::create_or_truncate);
        file.write_at(bytes, size, 0);
        file.sync();
        file.close();
        rename_path(temporary, path, "putting the new file in place");
    } catch (...) {
        ::unlink(temporary.c_str());
        throw;
    }
    sync_folder(folder_holding(path));
}

}  // namespace pcm
