// A tree whose chunks are changed one by one: attributes' values, and attributes that are added. Positions and nodes
// stay.
#pragma once

#include "pcm/cache/chunk_store.h"
#include "pcm/update/tree_update.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <unordered_map>
#include <vector>

namespace pcm {

// Holds the tree's lock as long as it lives. Changed chunks go to new data files behind the others; commit() makes them
// part of the tree at one instant. What ends before that, however it ends, leaves the tree of the last commit. A chunk
// that is written twice takes its place twice, until the tree is compacted. Any number of threads.
class TreeChanges final : public ChunkStore {
public:
    // Throws what TreeUpdate throws; Error(exists) when somebody else changes the tree.
    explicit TreeChanges(const std::filesystem::path& path);

    std::shared_ptr<const Tree> tree() const override;
    Chunk read(NodeId node, const ColumnSet& columns) const override;
    ChunkPart read_part(NodeId node, const ColumnSet& columns,
                        const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted) const override;
    bool writable() const override { return true; }
    void write(NodeId node, const Chunk& written, const ColumnSet& changed) override;
    void commit() override;

    // Lets go of the lock and of what was not committed; from then on the tree is read as it is on disk, and nothing is
    // written.
    void end();

    // At the end of the schema; its values are zero. Returns its place there. Throws what Schema::add throws.
    std::size_t add_attribute(const Attribute& attribute);

private:
    struct Place {  // of a chunk that was written since the last commit
        Extent extent;
        std::uint64_t hash = 0;
        std::size_t attributes = 0;  // that the tree had then
        std::shared_ptr<const File> file;
    };
    std::optional<Place> place_of(NodeId node) const;
    Chunk read_now(NodeId node, const ColumnSet& columns) const;
    std::uint64_t hash_with_added_attributes() const;
    void begin_again();
    void check_open() const;

    mutable std::shared_mutex mutex_;   // exclusive: commit and add_attribute
    mutable std::mutex file_mutex_;     // of what writers share
    std::optional<TreeUpdate> update_;  // nothing: it has ended
    std::shared_ptr<const Tree> tree_;
    std::unordered_map<NodeId, Place> places_;
    std::vector<std::shared_ptr<const File>> files_;  // by number, from the tree's own number of data files on
    std::uint64_t hash_ = 0;                          // of all points, while no attribute was added
    bool longer_schema_ = false;                      // than that of the last commit
};

}  // namespace pcm
