// The source of a cache's chunks, and the destination of those that were changed.
#pragma once

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/attribute.h"
#include "pcm/tree/tree.h"

#include <functional>
#include <memory>
#include <vector>

namespace pcm {

// Any number of threads may call.
class ChunkStore {
public:
    virtual ~ChunkStore() = default;

    // The tree whose chunks read() gives. Its nodes never change; attributes may be added to its schema.
    virtual std::shared_ptr<const Tree> tree() const = 0;

    // As Tree::read_chunk and read_chunk_part, for the chunk as it was last written.
    virtual Chunk read(NodeId node, const ColumnSet& columns) const = 0;
    virtual ChunkPart read_part(NodeId node, const ColumnSet& columns,
                                const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted) const = 0;

    // As Tree::read_chunks; without an own way, one after another.
    virtual void read_many(const std::vector<ChunkRequest>& requests, const TakeChunk& take) const;

    virtual bool writable() const { return false; }
    // Replaces a chunk by one with all its columns; `changed` names the columns that differ. Throws Error, and then the
    // old chunk stays.
    virtual void write(NodeId node, const Chunk& chunk, const ColumnSet& changed);
    // Makes everything written since the last commit() part of the tree on disk, atomically. Throws Error; nothing is
    // lost then, and a later commit() may succeed. An Error that is_done() says that everything is part of the tree,
    // but may not survive a loss of power.
    virtual void commit() {}
};

// The store of a tree that is only read.
class TreeStore final : public ChunkStore {
public:
    explicit TreeStore(std::shared_ptr<const Tree> tree) : tree_(std::move(tree)) {}
    std::shared_ptr<const Tree> tree() const override { return tree_; }
    Chunk read(NodeId node, const ColumnSet& columns) const override { return tree_->read_chunk(node, columns); }
    ChunkPart read_part(NodeId node, const ColumnSet& columns,
                        const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted) const override
    {
        return tree_->read_chunk_part(node, columns, wanted);
    }
    void read_many(const std::vector<ChunkRequest>& requests, const TakeChunk& take) const override
    {
        tree_->read_chunks(requests, take);
    }

private:
    const std::shared_ptr<const Tree> tree_;
};

}  // namespace pcm
