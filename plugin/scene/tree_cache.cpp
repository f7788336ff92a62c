#include "plugin/scene/tree_cache.h"

#include "pcm/system/error.h"
#include "pcm/system/file_lock.h"
#include "pcm/system/text.h"

#include <QCoreApplication>
#include <QStandardPaths>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <vector>

namespace pcm::host {

namespace fs = std::filesystem;

namespace {

const std::string session_prefix = "session-";
const std::string lock_suffix = ".lock";

std::uint64_t bytes_in(const fs::path& folder)
{
    std::uint64_t bytes = 0;
    std::error_code error;
    for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        std::error_code gone;
        if (it->is_regular_file(gone))
            if (const auto size = it->file_size(gone); !gone) bytes += size;
    }
    return bytes;
}

// Whether the descriptor is of the file that has this name: another process may have removed it in between.
bool is_file_at(int descriptor, const std::string& path)
{
    struct stat open {
    }, named{};
    return fstat(descriptor, &open) == 0 && stat(path.c_str(), &named) == 0 && open.st_ino == named.st_ino &&
           open.st_dev == named.st_dev;
}

// What cannot be locked is left to others.
FileLock lock_of(int descriptor, const std::string& path)
{
    try {
        return take_lock(descriptor, path);
    } catch (const Error&) {
        return FileLock::held;
    }
}

// Removes a session if nobody has its lock.
bool remove_session(const fs::path& folder)
{
    const std::string lock = folder.string() + lock_suffix;
    const int descriptor = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (descriptor < 0) return false;
    const bool ours = lock_of(descriptor, lock) == FileLock::taken && is_file_at(descriptor, lock);
    if (ours) {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
        fs::remove(lock, ignored);
    }
    ::close(descriptor);
    return ours;
}

}  // namespace

CachedTree::~CachedTree()
{
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

TreeCache& TreeCache::instance()
{
    static TreeCache* const cache = [] {
        const QString root = QStandardPaths::writableLocation(QStandardPaths::GenericCacheLocation);
        auto* made = new TreeCache(fs::path(root.toStdString()) / "pcm-meshlab");
        if (auto* application = QCoreApplication::instance())
            QObject::connect(application, &QCoreApplication::aboutToQuit, application, [made] { made->clear(); });
        return made;
    }();
    return *cache;
}

TreeCache::TreeCache(fs::path root, std::uint64_t most) : root_(std::move(root)), most_(most) {}

TreeCache::~TreeCache() { clear(); }

void TreeCache::make_session()
{
    std::error_code error;
    fs::create_directories(root_, error);
    if (error) throw Error::from_errno(error.value(), root_, "creating the folder for temporary trees");
    std::string lock;
    for (int attempt = 0; lock_ < 0 && attempt < 8; ++attempt) {
        lock = (root_ / (session_prefix + "XXXXXX" + lock_suffix)).string();
        const int descriptor = mkostemps(lock.data(), static_cast<int>(lock_suffix.size()), O_CLOEXEC);
        if (descriptor < 0) throw Error::from_errno(errno, root_, "creating a file in the folder for temporary trees");
        // Without locks nobody takes the session for one that has ended: it is removed at the end alone.
        if (lock_of(descriptor, lock) != FileLock::held && is_file_at(descriptor, lock))
            lock_ = descriptor;
        else
            ::close(descriptor);
    }
    if (lock_ < 0) throw Error(ErrorCode::io, root_, "no file can be locked in the folder for temporary trees");
    session_ = lock.substr(0, lock.size() - lock_suffix.size());
    if (mkdir(session_.c_str(), 0700) != 0) {
        const int number = errno;
        clear();
        throw Error::from_errno(number, root_, "creating a folder for temporary trees");
    }
}

std::shared_ptr<const CachedTree> TreeCache::reserve(std::uint64_t bytes)
{
    if (lock_ < 0) make_session();
    const std::uint64_t used = bytes_in(root_);
    if (used + bytes > most_)
        throw Error(ErrorCode::no_space, root_,
                    "the temporary trees would take " + bytes_text(used + bytes) + ", more than their limit of " +
                        bytes_text(most_));
    std::error_code unknown;
    const fs::space_info space = fs::space(root_, unknown);
    if (!unknown && bytes > space.available / 2)
        throw Error(ErrorCode::no_space, root_,
                    "a temporary tree needs " + bytes_text(bytes) + ", more than half of the free " +
                        bytes_text(space.available));
    return std::make_shared<const CachedTree>(session_ / (std::to_string(++number_) + ".pct"));
}

int TreeCache::remove_leftovers()
{
    // First the names, as the folder changes below.
    std::vector<fs::path> sessions;
    std::error_code error;
    for (fs::directory_iterator it(root_, error), end; !error && it != end; it.increment(error)) {
        const std::string name = it->path().filename().string();
        if (name.compare(0, session_prefix.size(), session_prefix) == 0 && it->path().extension() != lock_suffix)
            sessions.push_back(it->path());
    }
    int removed = 0;
    for (const fs::path& session : sessions)
        if (session != session_) removed += remove_session(session);
    return removed;
}

void TreeCache::clear()
{
    if (lock_ < 0) return;
    std::error_code ignored;
    fs::remove_all(session_, ignored);
    fs::remove(session_.string() + lock_suffix, ignored);
    ::close(lock_);
    lock_ = -1;
    session_.clear();
}

}  // namespace pcm::host
