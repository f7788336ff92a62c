// The data files of a tree, open for reading. A bounded number of them is open at a time.
//
// Any number of threads may call get(). A file that a caller holds stays open, so the bound is exceeded by at most one
// file per caller.
#pragma once

#include "pcm/system/byte_source.h"
#include "pcm/tree/tree.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <vector>

namespace pcm {

// Throws Error(not_found | permission | truncated | io) unless every file with bytes in use exists and is long enough.
void check_data_files(const std::filesystem::path& folder, const std::vector<DataFile>& files);

class DataFilePool {
public:
    // Up to `most_open` files with bytes in use are all opened now and stay open, so that they can be read even after
    // their names were removed from the folder; more are opened when they are used. Throws what get() throws.
    DataFilePool(const std::filesystem::path& folder, const std::vector<DataFile>& files, std::size_t most_open);

    // Opens the file if necessary; when too many are open, the least recently used one is closed. Throws
    // Error(not_found | permission | io), and Error(truncated) for a file that is shorter than its bytes in use.
    std::shared_ptr<const ByteSource> get(std::uint32_t number);
    std::size_t open_files() const;

private:
    struct Entry {
        std::shared_ptr<const ByteSource> file;  // null while closed
        std::list<std::uint32_t>::iterator use;  // in by_use_, while open
    };

    std::shared_ptr<const ByteSource> keep(std::uint32_t number, std::shared_ptr<const ByteSource> file);

    std::filesystem::path folder_;
    std::vector<DataFile> files_;
    std::size_t most_open_;
    mutable std::mutex mutex_;
    std::vector<Entry> entries_;
    std::list<std::uint32_t> by_use_;  // most recently used first
};

}  // namespace pcm
