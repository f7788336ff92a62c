// One change of a tree, from taking the lock to the new index.
#pragma once

#include "pcm/system/progress.h"
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

// Adds a warning when an update of the tree that has ended could not remove its scratch files.
void warn_of_scratch(const std::filesystem::path& tree, Outcome& outcome);

// Holds the tree's lock. Chunks are written to new data files; commit() makes them part of the tree atomically. Without
// a commit the tree is unchanged, and the destructor removes the files. For one thread.
class TreeUpdate {
public:
    // Opens the tree and removes the leftovers of an interrupted update. Throws what TreeLock and Tree::open throw, and
    // Error(exists) where another tree's file has the name of the next data file.
    explicit TreeUpdate(const std::filesystem::path& path);
    ~TreeUpdate();
    TreeUpdate(const TreeUpdate&) = delete;
    TreeUpdate& operator=(const TreeUpdate&) = delete;

    const std::shared_ptr<const Tree>& tree() const { return tree_; }
    const std::filesystem::path& folder() const { return tree_->folder(); }
    std::uint32_t generation() const { return generation_; }  // generation of the chunks to write
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
    // the new data files. All that can fail is done before: the new index is checked, and its data files are opened.
    // Throws an Error that is_done() when the new index is in place but might not survive a loss of power; after any
    // other error the tree is the old one.
    void commit(TreeInfo info, NodeVector joined);
    // As commit(). When the new tree is in place, another change may follow, of that tree and under the same lock:
    // then tree() is the new one, with or without an error.
    void commit_and_continue(TreeInfo info, NodeVector joined);
    std::uint64_t bytes_written() const { return bytes_written_; }

private:
    void begin_file();
    void replace_index(TreeInfo info, NodeVector joined, bool another_follows);

    TreeLock lock_;
    std::shared_ptr<const Tree> tree_;
    std::shared_ptr<const Tree> next_;  // what the tree will be when the new index is in place
    std::uint32_t generation_ = 0;
    File file_;
    std::vector<DataFile> files_;  // new ones
    std::uint64_t bytes_written_ = 0;
    bool committed_ = false, about_ahead_ = false;
};

ChunkIdentity identity_of(const PartNode& node, std::uint32_t generation);

}  // namespace pcm
