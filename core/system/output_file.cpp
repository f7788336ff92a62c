#include "pcm/system/output_file.h"

#include "pcm/system/error.h"
#include "pcm/system/output_path.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

namespace pcm {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

// Unique among the files of this process and of all others running.
std::filesystem::path temporary_beside(const std::filesystem::path& path)
{
    static std::atomic<unsigned> count{0};
    std::filesystem::path part = path;
    part += ".part-" + std::to_string(::getpid()) + "-" + std::to_string(count++);
    return part;
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path)
    : path_(path),
      place_(output_file(path)),
      part_(temporary_beside(place_)),
      file_(part_, File::Mode::create_or_truncate)
{
    buffer_.reserve(buffer_bytes);
}

OutputFile::~OutputFile()
{
    if (finished_) return;
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
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

void OutputFile::finish()
{
    if (finished_) throw Error(ErrorCode::invalid_argument, path_, "finish() was called twice");
    flush();
    file_.sync();
    file_.close();
    if (std::rename(part_.c_str(), place_.c_str()) != 0)
        throw Error::from_errno(errno, path_, "putting the finished file in place");
    finished_ = true;
}

}  // namespace pcm
