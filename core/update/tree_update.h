// One change of a tree, from taking the lock to the new index.
#pragma once

#include "pcm/system/tree_folder.h"
#include "pcm/tree/tree_index.h"
#include "pcm/tree/tree_lock.h"
#include "pcm/update/part_nodes.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pcm {

// Files in a tree's folder that an interrupted update has left: the index does not name them.
std::vector<std::filesystem::path> leftovers(const std::filesystem::path& folder, std::size_t data_files);

// Holds the tree's lock. Chunks are written to new data files; commit() makes them part of the tree atomically. Without
// a commit the tree stays as it was, and the destructor removes the files. For one thread.
class TreeUpdate {
public:
    // Opens the tree and removes the leftovers of an interrupted update. Throws what TreeLock and Tree::open throw.
    explicit TreeUpdate(const std::filesystem::path& path);
    ~TreeUpdate();
    TreeUpdate(const TreeUpdate&) = delete;
    TreeUpdate& operator=(const TreeUpdate&) = delete;

    const std::shared_ptr<const Tree>& tree() const { return tree_; }
    const std::filesystem::path& folder() const { return tree_->folder(); }
    std::uint32_t generation() const { return generation_; }  // of the chunks to write
    // Makes the folder for scratch files and returns its path.
    std::filesystem::path scratch();

    // Appends a chunk, made with identity_of(), to the new data files. Returns its extent.
    Extent write(const std::vector<std::byte>& chunk);
    // The next chunk goes to another new data file.
    void end_file();
    // Takes over data files of the given sizes that the caller has written and synced, numbered after the tree's. Only
    // before the first write().
    void adopt(const std::vector<std::uint64_t>& bytes);
    // Writes a tombstone: the node has no points from this generation on.
    void write_tombstone(const PartNode& node);

    // Replaces the index: the tree becomes `info` (but its generation) and `joined`, whose chunks are in the old and
    // the new data files. When the new index is in place but might not survive a loss of power, it throws, and the tree
    // is the new one.
    void commit(TreeInfo info, NodeVector joined);
    // Whether the tree on disk is the new one.
    bool committed() const { return committed_; }
    // After a commit: starts another change, of the new tree, under the same lock.
    void start_next();
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
