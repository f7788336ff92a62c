// A change of a tree, from the lock to the new index.
#pragma once

#include "pcm/tree/tree_index.h"
#include "pcm/update/part_nodes.h"
#include "pcm/tree/tree_lock.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pcm {

inline constexpr const char* update_scratch_name =
    "update.tmp";  // a folder in the tree's, for what an update needs on the way

// Files in a tree's folder that its index knows nothing of: what an update has left that was interrupted.
std::vector<std::filesystem::path> leftovers(const std::filesystem::path& folder, std::size_t data_files);

// Holds the tree's lock. What is written goes into new data files; commit() makes them part of the tree, at one
// instant. Whatever ends before that leaves the tree as it was, and removes the files. One thread.
class TreeUpdate {
public:
    // Opens the tree, and removes what an interrupted update has left in its folder. Throws what TreeLock and
    // Tree::open throw.
    explicit TreeUpdate(const std::filesystem::path& path);
    ~TreeUpdate();
    TreeUpdate(const TreeUpdate&) = delete;
    TreeUpdate& operator=(const TreeUpdate&) = delete;

    const std::shared_ptr<const Tree>& tree() const { return tree_; }
    const std::filesystem::path& folder() const { return tree_->folder(); }
    std::uint32_t generation() const { return generation_; }  // of what is written
    // Makes the folder for scratch files.
    std::filesystem::path scratch();

    // Appends a chunk, made with identity_of(), to the new data files. Returns where it lies.
    Extent write(const std::vector<std::byte>& chunk);
    // What is written next goes into a new data file.
    void end_file();
    // Takes over data files that somebody else has written and synced, numbered on from the tree's, of so many bytes
    // each. Only before anything is written here.
    void adopt(const std::vector<std::uint64_t>& bytes);
    // Notes that a node has no points any more.
    void bury(const PartNode& node);

    // The tree is from now on what `info` (but its generation) and `joined` say, whose nodes lie in the old data files
    // and the new ones. When the new index is in place but may not outlast a loss of power, it throws, and the tree is
    // the new one.
    void commit(TreeInfo info, NodeVector joined);
    // Whether the tree on disk is the new one.
    bool committed() const { return committed_; }
    // After a commit: another change, of the tree as it is now, under the same lock.
    void go_on();
    std::uint64_t bytes_written() const { return bytes_written_; }

private:
    void begin_file();

    TreeLock lock_;
    std::shared_ptr<const Tree> tree_;
    std::uint32_t generation_ = 0;
    File file_;
    std::vector<DataFile> files_;  // new ones
    std::uint64_t bytes_written_ = 0;
    bool committed_ = false, about_ahead_ = false;
};

ChunkIdentity identity_of(const PartNode& node, std::uint32_t generation);

}  // namespace pcm
