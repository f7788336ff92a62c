#include "pcm/system/part_file.h"

#include "pcm/system/error.h"
#include "pcm/system/file_lock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <system_error>
#include <utility>
#include <vector>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr const char* infix = ".part-";

bool is_abandoned(const fs::path& part)
{
    const int descriptor = ::open(part.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) return false;
    struct stat status {};
    bool abandoned = false;
    try {
        abandoned = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
                    take_lock(descriptor, part) == FileLock::taken;
    } catch (const Error&) {  // it stays
    }
    ::close(descriptor);
    return abandoned;
}

// False when another process took the new part for an abandoned one before it was locked.
bool lock_part(const File& file)
{
    if (take_lock(file.descriptor(), file.path()) == FileLock::held) return false;
    struct stat status {};
    return ::fstat(file.descriptor(), &status) != 0 || status.st_nlink > 0;
}

void copy(const File& from, File& to)
{
    std::vector<std::byte> buffer(std::size_t{1} << 20);
    for (std::uint64_t at = 0;;) {
        const std::size_t got = from.read_some_at(buffer.data(), buffer.size(), at);
        if (got == 0) return;
        to.write_at(buffer.data(), got, at);
        at += got;
    }
}

}  // namespace

fs::path new_part_name(const fs::path& output)
{
    static std::atomic<unsigned> count{0};
    fs::path part = output;
    part += infix + std::to_string(::getpid()) + "-" + std::to_string(count++);
    return part;
}

bool is_part_name(const std::string& name, const std::string& output)
{
    const std::string start = output + infix;
    if (name.compare(0, start.size(), start) != 0) return false;
    const std::string rest = name.substr(start.size());
    const auto dash = rest.find('-');
    return dash != std::string::npos && dash > 0 && dash + 1 < rest.size() &&
           rest.find_first_not_of("0123456789") == dash &&
           rest.find_first_not_of("0123456789", dash + 1) == std::string::npos;
}

File make_part(const fs::path& output)
{
    for (;;) {
        File file(new_part_name(output), File::Mode::create_or_truncate);
        if (lock_part(file)) return file;
        std::error_code ignored;
        fs::remove(file.path(), ignored);
    }
}

fs::path name_part(File& file, const fs::path& output)
{
    try {
        const fs::path part = new_part_name(output);
        if (!file.give_name(part)) throw Error(ErrorCode::exists, part, "there is a file of this name already");
        return part;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::unsupported) throw;
    }
    File part = make_part(output);
    try {
        copy(file, part);
        part.sync();
    } catch (...) {
        std::error_code ignored;
        fs::remove(part.path(), ignored);
        throw;
    }
    file = std::move(part);
    return file.path();
}

void remove_abandoned_parts(const fs::path& output)
{
    std::error_code error;
    const std::string name = output.filename().string();
    fs::directory_iterator at(folder_holding(output), error);
    for (; !error && at != fs::directory_iterator(); at.increment(error)) {
        std::error_code ignored;
        if (is_part_name(at->path().filename().string(), name) && is_abandoned(at->path()))
            fs::remove(at->path(), ignored);
    }
}

}  // namespace pcm
