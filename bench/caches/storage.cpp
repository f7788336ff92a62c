#include "bench/caches/storage.h"

#include "bench/caches/row.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace pcm::bench {
namespace {

struct File {
    int number;
    File(const std::filesystem::path& path, int flags) : number(::open(path.c_str(), flags | O_CLOEXEC)) {}
    ~File()
    {
        if (number >= 0) ::close(number);
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
};

[[noreturn]] void fail(const std::string& what, const std::filesystem::path& path)
{
    throw std::runtime_error("cannot " + what + " " + path.string() + ": " + std::strerror(errno));
}

void for_each_file(const std::filesystem::path& tree, const std::function<void(const std::filesystem::path&)>& work)
{
    for (const auto& entry : std::filesystem::recursive_directory_iterator(tree))
        if (entry.is_regular_file()) work(entry.path());
}

// Reads to the end; false when the first read is refused.
bool read_all(const File& file, const std::filesystem::path& path, void* buffer, std::size_t size, Reading& reading)
{
    for (bool first = true;; first = false) {
        const ssize_t got = ::read(file.number, buffer, size);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0 && first && errno == EINVAL) return false;
        if (got < 0) fail("read", path);
        if (got == 0) return true;
        reading.bytes += static_cast<std::uint64_t>(got);
    }
}

}  // namespace

void drop_from_cache(const std::filesystem::path& tree)
{
    for_each_file(tree, [](const std::filesystem::path& path) {
        const File file(path, O_RDONLY);
        if (file.number < 0) fail("open", path);
        // Only clean pages are dropped. A file system that is mounted read-only refuses the first, and has no dirty
        // ones.
        ::fdatasync(file.number);
        if (const int error = ::posix_fadvise(file.number, 0, 0, POSIX_FADV_DONTNEED)) {
            errno = error;
            fail("drop from the cache", path);
        }
    });
}

double share_in_cache(const std::filesystem::path& tree)
{
    std::size_t pages = 0, held = 0;
    const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    for_each_file(tree, [&](const std::filesystem::path& path) {
        const File file(path, O_RDONLY);
        struct stat status {};
        if (file.number < 0 || ::fstat(file.number, &status) != 0) fail("open", path);
        const auto size = static_cast<std::size_t>(status.st_size);
        if (size == 0) return;
        void* const at = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, file.number, 0);
        if (at == MAP_FAILED) fail("map", path);
        std::vector<unsigned char> resident((size + page - 1) / page);
        const bool known = ::mincore(at, size, resident.data()) == 0;
        ::munmap(at, size);
        if (!known) fail("ask what is in memory of", path);
        pages += resident.size();
        for (const unsigned char r : resident) held += r & 1u;
    });
    return pages ? static_cast<double>(held) / static_cast<double>(pages) : 0;
}

Reading read_files(const std::filesystem::path& tree)
{
    Reading reading;
    std::vector<char> buffer(std::size_t(1) << 20);
    const auto start = Clock::now();
    for_each_file(tree, [&](const std::filesystem::path& path) {
        const File file(path, O_RDONLY);
        if (file.number < 0) fail("open", path);
        ::posix_fadvise(file.number, 0, 0, POSIX_FADV_SEQUENTIAL);
        if (!read_all(file, path, buffer.data(), buffer.size(), reading)) fail("read", path);
    });
    reading.seconds = seconds_since(start);
    return reading;
}

Reading read_files_direct(const std::filesystem::path& tree)
{
    constexpr std::size_t size = std::size_t(4) << 20, alignment = 4096;
    const std::unique_ptr<void, decltype(&std::free)> buffer(std::aligned_alloc(alignment, size), &std::free);
    if (!buffer) throw std::bad_alloc();
    Reading reading;
    bool possible = true;
    const auto start = Clock::now();
    for_each_file(tree, [&](const std::filesystem::path& path) {
        const File file(path, O_RDONLY | O_DIRECT);
        if (file.number < 0 && errno != EINVAL) fail("open", path);
        possible = possible && file.number >= 0 && read_all(file, path, buffer.get(), size, reading);
    });
    reading.seconds = seconds_since(start);
    return possible ? reading : Reading();
}

}  // namespace pcm::bench
