// The data files of a tree, open for reading: a bounded number of them at once.
//
// Any number of threads may call get(). A file that a caller holds stays open, so there are at most as many more open
// files as callers.
#pragma once

#include "pcm/system/file.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <vector>

namespace pcm {

class DataFilePool {
public:
    // Checks that each file with bytes in use is there and as long as that. When there are at most `most_open` of them
    // all are opened now, and stay open: what others do to the folder's names does not matter then. Throws
    // Error(not_found | permission | truncated | io).
    DataFilePool(const std::filesystem::path& folder, const std::vector<DataFile>& files, std::size_t most_open);

    // Opens the file unless it is open, and closes the one not used for longest when that makes too many.
    std::shared_ptr<const File> get(std::uint32_t number);
    std::size_t open_files() const;

private:
    struct Entry {
        std::shared_ptr<const File> file;        // null while it is closed
        std::list<std::uint32_t>::iterator use;  // in by_use_, while it is open
    };

    std::shared_ptr<const File> keep(std::uint32_t number, std::shared_ptr<const File> file);

    std::filesystem::path folder_;
    std::size_t most_open_;
    mutable std::mutex mutex_;
    std::vector<Entry> entries_;
    std::list<std::uint32_t> by_use_;  // last used first
};

}  // namespace pcm
