// Changes the chunks of a tree one by one: values of attributes, and attributes that are added. Positions and nodes
// stay.
#pragma once

#include "pcm/cache/chunk_store.h"
#include "pcm/system/file.h"
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

// Holds the tree's lock as long as it lives. Changed chunks go to new data files; commit() makes them part of the tree
// atomically; an Error of it that is_done() says that they are, but may not survive a loss of power. Whatever ends
// before the commit, also in a crash, leaves the tree of the last commit. A chunk that is written twice takes its space
// twice until the tree is compacted. Any number of threads may call.
class TreeChanges final : public ChunkStore {
public:
    // Throws what TreeUpdate throws; Error(exists) when another process or thread changes the tree.
    explicit TreeChanges(const std::filesystem::path& path);

    std::shared_ptr<const Tree> tree() const override;
    Chunk read(NodeId node, const ColumnSet& columns) const override;
    ChunkPart read_part(NodeId node, const ColumnSet& columns,
                        const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted) const override;
    void read_many(const std::vector<ChunkRequest>& requests, const TakeChunk& take) const override;
    bool writable() const override { return true; }
    void write(NodeId node, const Chunk& written, const ColumnSet& changed) override;
    void commit() override;
    // write() for a chunk that another process has encoded, with all attributes of the schema as it is now, under the
    // generation after that of the last commit. `hash_before`, `hash`: content hashes of its points, before and
    // now (point_hash.h).
    void put(NodeId node, const std::vector<std::byte>& bytes, std::uint64_t hash_before, std::uint64_t hash);

    // Releases the lock and drops what was not committed. From then on the tree is read as of the last commit, and
    // write() throws.
    void end();

    // Adds an attribute at the end of the schema; its values are zero. Returns its number. Throws what Schema::add
    // throws.
    std::size_t add_attribute(const Attribute& attribute);

private:
    struct Place {  // place of a chunk that was written since the last commit
        Extent extent;
        std::uint64_t hash = 0;
        std::size_t attributes = 0;  // number of the tree's attributes when the chunk was written
        std::shared_ptr<const File> file;
    };
    std::optional<Place> place_of(NodeId node) const;
    void keep(NodeId node, const std::vector<std::byte>& bytes, std::uint64_t hash_before, std::uint64_t hash);
    Chunk read_now(NodeId node, const ColumnSet& columns) const;
    std::uint64_t hash_with_added_attributes() const;
    void take_next_tree();
    void check_open() const;

    mutable std::shared_mutex mutex_;   // exclusive: commit and add_attribute
    mutable std::mutex file_mutex_;     // guards what writers share
    std::optional<TreeUpdate> update_;  // none after end()
    std::shared_ptr<const Tree> tree_;
    std::unordered_map<NodeId, Place> places_;
    std::vector<std::shared_ptr<const File>> files_;  // files by number, from the tree's own number of data files on
    std::uint64_t hash_ = 0;                          // content hash; not kept up to date after an attribute was added
    bool longer_schema_ = false;                      // attributes were added since the last commit
};

}  // namespace pcm
