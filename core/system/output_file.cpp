#include "pcm/system/output_file.h"

#include "pcm/system/error.h"
#include "pcm/system/file_lock.h"
#include "pcm/system/output_group.h"
#include "pcm/system/output_path.h"
#include "pcm/system/part_file.h"

#include <cstring>

namespace pcm {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path) : path_(path), place_(output_file(path))
{
    remove_abandoned_parts(place_);
    file_ = File::without_name(place_);
    if (file_.is_open()) {
        take_lock(file_.descriptor(), place_);  // it may become a part in put_in_place()
    } else {
        file_ = make_part(place_);
        part_ = file_.path();
    }
    buffer_.reserve(buffer_bytes);
}

OutputFile::~OutputFile()
{
    if (finished_ || part_.empty()) return;
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

void OutputFile::put_in_place()
{
    if (part_.empty()) {
        try {
            if (file_.give_name(place_)) return;
        } catch (const Error& error) {
            if (error.code() != ErrorCode::unsupported) throw;
        }
        part_ = name_part(file_, place_);
    }
    rename_path(part_, place_, "putting the finished file in place");
}

void OutputFile::finish()
{
    OutputGroup* const group = OutputGroup::current();
    if (!group) {
        finish_if([] { return true; });
        return;
    }
    complete();
    group->add(path_, place_, part_, file_);
    finished_ = true;
}

void OutputFile::complete()
{
    if (finished_) throw Error(ErrorCode::invalid_argument, path_, "finish() was called twice");
    flush();
    file_.sync();
}

bool OutputFile::finish_if(const std::function<bool()>& condition)
{
    complete();
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
