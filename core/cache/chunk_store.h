// Where a cache has its chunks from, and where it puts those that were changed.
#pragma once

#include "pcm/tree/tree.h"

#include <functional>
#include <memory>

namespace pcm {

// Any number of threads.
class ChunkStore {
public:
    virtual ~ChunkStore() = default;

    // Its nodes, whose chunks read() gives; the same nodes all the time, while the schema may get longer.
    virtual std::shared_ptr<const Tree> tree() const = 0;

    // As Tree::read_chunk and read_chunk_part, of the chunk as it was written last.
    virtual Chunk read(NodeId node, const ColumnSet& columns) const = 0;
    virtual ChunkPart read_part(NodeId node, const ColumnSet& columns,
                                const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted) const = 0;

    virtual bool writable() const { return false; }
    // A chunk with all its columns, in place of the one that was there; `changed` are those that differ. Throws Error,
    // and then the chunk is the one that was there.
    virtual void write(NodeId node, const Chunk& chunk, const ColumnSet& changed);
    // What was written since the last commit() becomes part of the tree on disk, all at once. Throws Error; all is
    // still there then, to be committed later.
    virtual void commit() {}
};

// Of a tree that nobody changes through this store.
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

private:
    const std::shared_ptr<const Tree> tree_;
};

}  // namespace pcm
