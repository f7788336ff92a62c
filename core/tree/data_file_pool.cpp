#include "pcm/tree/data_file_pool.h"

#include "pcm/system/error.h"
#include "pcm/tree/tree_index.h"

#include <algorithm>
#include <string>

namespace pcm {

DataFilePool::DataFilePool(const std::filesystem::path& folder, const std::vector<DataFile>& files,
                           std::size_t most_open)
    : folder_(folder), most_open_(std::max<std::size_t>(most_open, 1)), entries_(files.size())
{
    std::size_t used = 0;
    for (const DataFile& file : files) used += file.bytes > 0;
    for (std::uint32_t i = 0; i < files.size(); ++i) {
        if (files[i].bytes == 0) continue;
        auto file = std::make_shared<const File>(folder_ / data_file_name(i), File::Mode::read);
        if (file->size() < files[i].bytes)
            throw Error(ErrorCode::truncated, file->path(),
                        "the file has " + std::to_string(file->size()) + " bytes, the index expects " +
                            std::to_string(files[i].bytes));
        if (used <= most_open_) keep(i, std::move(file));
    }
}

std::shared_ptr<const File> DataFilePool::get(std::uint32_t number)
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
    return keep(number, std::make_shared<const File>(folder_ / data_file_name(number), File::Mode::read));
}

std::size_t DataFilePool::open_files() const
{
    const std::lock_guard lock(mutex_);
    return by_use_.size();
}

std::shared_ptr<const File> DataFilePool::keep(std::uint32_t number, std::shared_ptr<const File> file)
{
    std::shared_ptr<const File> closed;  // closed after the lock is released
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
