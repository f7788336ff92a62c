#include "pcm/system/update_file.h"

#include "pcm/system/error.h"
#include "pcm/system/file_lock.h"
#include "pcm/system/output_file.h"
#include "pcm/system/output_path.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <thread>

namespace pcm {
namespace {

// Takes the lock otherwise, where there are locks. Network file systems also refuse that of a folder, which is open for
// reading alone.
bool is_held(int descriptor, const std::filesystem::path& file)
{
    try {
        return take_lock(descriptor, file) == FileLock::held;
    } catch (const Error&) {
        return false;
    }
}

class FolderLock {
public:
    FolderLock(const std::filesystem::path& file, std::chrono::milliseconds patience)
        : descriptor_(::open(folder_holding(file).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC))
    {
        if (descriptor_ < 0) throw Error::from_errno(errno, folder_holding(file), "opening the folder");
        const auto last = std::chrono::steady_clock::now() + patience;
        while (is_held(descriptor_, file)) {
            if (std::chrono::steady_clock::now() >= last) {
                ::close(descriptor_);
                throw Error(ErrorCode::io, file, "another process keeps the folder of this file locked",
                            "try again when it has finished, or use a file in another folder");
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    }
    ~FolderLock() { ::close(descriptor_); }
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int descriptor_;
};

// Which file has the name, and in which state; all zero where none has.
struct Identity {
    dev_t device = 0;
    ino_t inode = 0;
    off_t size = 0;
    timespec modified{}, changed{};

    explicit Identity(const std::filesystem::path& file)
    {
        struct stat status {};
        if (::stat(file.c_str(), &status) != 0) return;
        device = status.st_dev;
        inode = status.st_ino;
        size = status.st_size;
        modified = status.st_mtim;
        changed = status.st_ctim;
    }
    bool operator==(const Identity& other) const
    {
        const auto same = [](const timespec& a, const timespec& b) {
            return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
        };
        return device == other.device && inode == other.inode && size == other.size && same(modified, other.modified) &&
               same(changed, other.changed);
    }
};

}  // namespace

void update_file(const std::filesystem::path& file, const std::function<std::string()>& change,
                 std::chrono::milliseconds patience)
{
    constexpr int most_attempts = 100;
    const std::filesystem::path place = output_file(file);
    const FolderLock lock(place, patience);
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
        const Identity before(place);
        const std::string text = change();
        OutputFile output(file);
        output.append(text);
        if (output.finish_if([&] { return Identity(place) == before; })) return;
    }
    throw Error(ErrorCode::io, file, "other programs change this file all the time",
                "try again when they have finished");
}

}  // namespace pcm
