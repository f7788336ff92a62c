// Trees that exist only while MeshLab runs, in the user's cache folder ($XDG_CACHE_HOME or ~/.cache, then pcm-meshlab).
//
// Each process has a folder there, with a locked file in it. A folder whose file is not locked belonged to a process
// that ended without removing it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace pcm::host {

// A place for one tree. Its folder is removed with this object, also while the tree is being read.
class CachedTree {
public:
    explicit CachedTree(std::filesystem::path folder) : folder_(std::move(folder)) {}
    ~CachedTree();
    CachedTree(const CachedTree&) = delete;
    CachedTree& operator=(const CachedTree&) = delete;

    const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
};

class TreeCache {
public:
    static constexpr std::uint64_t most_bytes = std::uint64_t(4) << 30;  // sum over all processes of the user

    // The user's. Never destroyed; its folder is removed when the program ends in order.
    static TreeCache& instance();

    explicit TreeCache(std::filesystem::path root, std::uint64_t most = most_bytes);
    ~TreeCache();
    TreeCache(const TreeCache&) = delete;
    TreeCache& operator=(const TreeCache&) = delete;

    // For a tree that takes this many bytes while it is built. Throws Error(no_space) if all trees together would take
    // more than the limit, or more than half of what is free, and what the file system throws.
    std::shared_ptr<const CachedTree> reserve(std::uint64_t bytes);

    // Removes the folders of processes that ended without doing it. Returns their number; errors are ignored.
    int remove_leftovers();

    // Removes the folder of this process. The next reservation makes a new one.
    void clear();

private:
    void make_session();

    std::filesystem::path root_, session_;
    std::uint64_t most_;
    int lock_ = -1;  // file descriptor
    std::uint64_t number_ = 0;
};

}  // namespace pcm::host
