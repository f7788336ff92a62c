#include "pcm/tree/data_file_pool.h"

#include "pcm/remote/open_bytes.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/system/url.h"
#include "pcm/tree/tree_index.h"

#include <algorithm>
#include <string>

namespace pcm {

namespace {

std::shared_ptr<const ByteSource> open_whole(const std::filesystem::path& folder, std::uint32_t number,
                                             const DataFile& expected)
{
    const std::filesystem::path path = folder / data_file_name(number);
    if (is_url(path)) return open_bytes(path);  // its size is known when something of it is read
    auto file = std::make_shared<const File>(path, File::Mode::read);
    if (file->size() < expected.bytes)
        throw Error(ErrorCode::truncated, file->path(),
                    "the file has " + std::to_string(file->size()) + " bytes, the index expects " +
                        std::to_string(expected.bytes));
    file->expect_scattered_reads();  // reading ahead would bring columns that nobody asked for
    return file;
}

}  // namespace

void check_data_files(const std::filesystem::path& folder, const std::vector<DataFile>& files)
{
    for (std::uint32_t i = 0; i < files.size(); ++i)
        if (files[i].bytes > 0) open_whole(folder, i, files[i]);
}

DataFilePool::DataFilePool(const std::filesystem::path& folder, const std::vector<DataFile>& files,
                           std::size_t most_open)
    : folder_(folder), files_(files), most_open_(std::max<std::size_t>(most_open, 1)), entries_(files.size())
{
    std::size_t used = 0;
    for (const DataFile& file : files) used += file.bytes > 0;
    if (used > most_open_) return;
    for (std::uint32_t i = 0; i < files.size(); ++i)
        if (files[i].bytes > 0) keep(i, open_whole(folder_, i, files[i]));
}

std::shared_ptr<const ByteSource> DataFilePool::get(std::uint32_t number)
{
    {
        const std::lock_guard lock(mutex_);
        Entry& entry = entries_.at(number);
        if (entry.file) {
            by_use_.splice(by_use_.begin(), by_use_, entry.use);
            return entry.file;
        }
    }
    // Without the lock: opening may take long, and readers of open files must not wait for it.
    return keep(number, open_whole(folder_, number, files_[number]));
}

std::size_t DataFilePool::open_files() const
{
    const std::lock_guard lock(mutex_);
    return by_use_.size();
}

std::shared_ptr<const ByteSource> DataFilePool::keep(std::uint32_t number, std::shared_ptr<const ByteSource> file)
{
    std::shared_ptr<const ByteSource> closed;  // closed after the lock is released
    const std::lock_guard lock(mutex_);
    Entry& entry = entries_[number];
    if (entry.file) return entry.file;  // opened by another thread meanwhile
    if (by_use_.size() >= most_open_) {
        closed = std::move(entries_[by_use_.back()].file);
        entries_[by_use_.back()].file = nullptr;
        by_use_.pop_back();
    }
    by_use_.push_front(number);
    entry.use = by_use_.begin();
    entry.file = std::move(file);
    return entry.file;
}

}  // namespace pcm
