#include "pcm/system/output_file.h"

#include "pcm/system/error.h"
#include "pcm/system/output_path.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

constexpr const char* part_infix = ".part-";

// Unique among the files of this process and of all others running.
std::filesystem::path temporary_beside(const std::filesystem::path& path)
{
    static std::atomic<unsigned> count{0};
    std::filesystem::path part = path;
    part += part_infix + std::to_string(::getpid()) + "-" + std::to_string(count++);
    return part;
}

bool is_part_of(const std::string& name, const std::string& output)
{
    const std::string start = output + part_infix;
    if (name.compare(0, start.size(), start) != 0) return false;
    const std::string rest = name.substr(start.size());
    const auto dash = rest.find('-');
    return dash != std::string::npos && dash > 0 && dash + 1 < rest.size() &&
           rest.find_first_not_of("0123456789") == dash &&
           rest.find_first_not_of("0123456789", dash + 1) == std::string::npos;
}

// A part that nobody holds a lock on belongs to a process that was killed.
bool is_abandoned(const std::filesystem::path& part)
{
    const int descriptor = ::open(part.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) return false;
    struct stat status {};
    const bool abandoned =
        ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
    ::close(descriptor);
    return abandoned;
}

void remove_abandoned_parts(const std::filesystem::path& path)
{
    std::error_code error;
    const std::string name = path.filename().string();
    std::filesystem::directory_iterator at(folder_holding(path), error);
    for (; !error && at != std::filesystem::directory_iterator(); at.increment(error)) {
        std::error_code ignored;
        if (is_part_of(at->path().filename().string(), name) && is_abandoned(at->path()))
            std::filesystem::remove(at->path(), ignored);
    }
}

// False when another process took the new part for an abandoned one before it was locked. Where the file system has no
// locks, parts are not removed either.
bool lock_part(const File& file)
{
    if (::flock(file.descriptor(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
    struct stat status {};
    return ::fstat(file.descriptor(), &status) != 0 || status.st_nlink > 0;
}

void copy(const File& from, File& to)
{
    std::vector<std::byte> buffer(buffer_bytes);
    for (std::uint64_t at = 0;;) {
        const std::size_t got = from.read_some_at(buffer.data(), buffer.size(), at);
        if (got == 0) return;
        to.write_at(buffer.data(), got, at);
        at += got;
    }
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path) : path_(path), place_(output_file(path))
{
    remove_abandoned_parts(place_);
    file_ = File::without_name(place_);
    if (file_.is_open())
        ::flock(file_.descriptor(), LOCK_EX | LOCK_NB);  // it may become a part in put_in_place()
    else
        create_part();
    buffer_.reserve(buffer_bytes);
}

OutputFile::~OutputFile()
{
    if (finished_ || part_.empty()) return;
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
}

void OutputFile::create_part()
{
    for (;;) {
        part_ = temporary_beside(place_);
        file_ = File(part_, File::Mode::create_or_truncate);
        if (lock_part(file_)) return;
        std::error_code ignored;
        std::filesystem::remove(part_, ignored);
    }
}

void OutputFile::flush()
{
    if (buffer_.empty()) return;
    file_.write_at(buffer_.data(), buffer_.size(), written_);
    written_ += buffer_.size();
    buffer_.clear();
}

std::byte* OutputFile::extend(std::size_t count)
{
    if (buffer_.size() + count > buffer_bytes) flush();
    const std::size_t start = buffer_.size();
    buffer_.resize(start + count);
    return buffer_.data() + start;
}

void OutputFile::append(const void* bytes, std::size_t count)
{
    if (count > buffer_bytes) {  // larger than the buffer: copying it there gains nothing
        flush();
        file_.write_at(bytes, count, written_);
        written_ += count;
    } else if (count) {
        std::memcpy(extend(count), bytes, count);
    }
}

void OutputFile::rewrite(const void* bytes, std::size_t count, std::uint64_t offset)
{
    if (offset > size() || count > size() - offset)
        throw Error(ErrorCode::invalid_argument, path_, "bytes beyond the end of the file were to be rewritten");
    flush();
    file_.write_at(bytes, count, offset);
}

void OutputFile::put_in_place()
{
    if (part_.empty()) {
        try {
            if (file_.give_name(place_)) return;
            const std::filesystem::path part = temporary_beside(place_);
            if (!file_.give_name(part)) throw Error(ErrorCode::exists, part, "there is a file of this name already");
            part_ = part;
        } catch (const Error& error) {
            if (error.code() != ErrorCode::unsupported) throw;
            const File unnamed = std::move(file_);
            create_part();
            copy(unnamed, file_);
            file_.sync();
        }
    }
    rename_path(part_, place_, "putting the finished file in place");
}

void OutputFile::finish()
{
    finish_if([] { return true; });
}

bool OutputFile::finish_if(const std::function<bool()>& condition)
{
    if (finished_) throw Error(ErrorCode::invalid_argument, path_, "finish() was called twice");
    flush();
    file_.sync();
    const OpenFolder folder(folder_holding(place_));
    if (!condition()) return false;
    put_in_place();
    finished_ = true;
    try {
        folder.sync();
        file_.close();
    } catch (const Error& error) {
        throw Error::after(path_, "the file is complete and in place", error);
    }
    return true;
}

}  // namespace pcm
