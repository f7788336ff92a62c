// A store of chunks in memory that fails on demand, and the tree that it stands for.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/cache/chunk_store.h"
#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/support.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

namespace pcm::test {

using Value = std::uint16_t;
// u16 attributes of one component, each with one value in all points of a chunk.
inline constexpr std::size_t columns_used = 3;

// Keeps chunks in memory: positions of a real tree, and one value per column.
class FakeStore final : public ChunkStore {
public:
    explicit FakeStore(std::shared_ptr<const Tree> tree) : tree_(std::move(tree))
    {
        for (NodeId id = 0; id < tree_->nodes().size(); ++id)
            chunks_.push_back(tree_->read_chunk(id, ColumnSet::whole(tree_->info().schema)));
    }
    std::shared_ptr<const Tree> tree() const override { return tree_; }
    Chunk read(NodeId node, const ColumnSet& columns) const override
    {
        if (fail_reads) throw Error(ErrorCode::truncated, "store", "the file ends early");
        const std::lock_guard lock(mutex_);
        ++reads;
        last_asked = columns;
        Chunk chunk = chunks_[node];
        if (!columns.positions) chunk.positions.reset();
        if (!columns.sizes) chunk.sizes.reset();
        for (std::size_t k = 0; k < chunk.attributes.size(); ++k)
            if (!columns.attributes.test(k)) chunk.attributes[k].reset();
        return chunk;
    }
    ChunkPart read_part(NodeId, const ColumnSet&,
                        const std::function<bool(const Box3i&, std::uint16_t)>&) const override
    {
        return {};
    }
    bool writable() const override { return true; }
    void write(NodeId node, const Chunk& chunk, const ColumnSet& changed) override
    {
        if (fail_writes) throw Error(ErrorCode::no_space, "store", "the disk is full");
        const std::lock_guard lock(mutex_);
        EXPECT_TRUE(chunk.columns().contains(ColumnSet::whole(tree_->info().schema)));
        EXPECT_EQ(std::memcmp(chunk.sizes->data(), chunks_[node].sizes->data(), chunk.points), 0);
        EXPECT_TRUE(changed.attributes.any());
        // Columns that are not reported as changed must be the same.
        for (std::size_t k = 0; k < chunk.attributes.size(); ++k)
            if (!changed.attributes.test(k)) {
                EXPECT_EQ(std::memcmp(chunk.attributes[k]->data(), chunks_[node].attributes[k]->data(),
                                      chunk.attributes[k]->bytes()),
                          0);
            }
        chunks_[node] = chunk;
        ++writes;
    }
    void commit() override
    {
        if (fail_commits) throw Error(ErrorCode::io, "store", "the disk does not answer");
        const std::lock_guard lock(mutex_);
        committed_ = chunks_;
    }
    Value committed(NodeId node, std::size_t column) const
    {
        return committed_[node].attributes[column]->as<Value>()[0];
    }

    std::atomic<bool> fail_reads{false}, fail_writes{false}, fail_commits{false};
    mutable std::atomic<std::uint64_t> reads{0}, writes{0};
    mutable ColumnSet last_asked;  // columns of the last read(); one thread at a time

private:
    const std::shared_ptr<const Tree> tree_;
    mutable std::mutex mutex_;
    std::vector<Chunk> chunks_, committed_;
};

class L2Changes : public testing::Test {
protected:
    void SetUp() override
    {
        auto points = records(Shape::surface, 30000, 3);
        for (LasRecord& p : points) p.intensity = p.source = 0;
        write_las(folder_ / "in.las", points, {});
        BuildOptions options;
        options.chunk_points = 1000;
        options.threads = 2;
        build_tree({folder_ / "in.las"}, folder_ / "out.pct", options);
        auto tree = Tree::open(folder_ / "out.pct");
        ASSERT_GT(tree->nodes().size(), 30u);
        slots_ = {*tree->info().schema.find("intensity"), *tree->info().schema.find("point_source_id")};
        store_ = std::make_shared<FakeStore>(tree);
    }
    ColumnSet columns(bool positions, unsigned which) const
    {
        ColumnSet columns;
        columns.positions = positions;
        for (std::size_t c = 0; c < slots_.size(); ++c)
            if (which >> c & 1) columns.attributes.set(slots_[c]);
        return columns;
    }

    TemporaryFolder folder_;
    std::vector<std::size_t> slots_;
    std::shared_ptr<FakeStore> store_;
};

}  // namespace pcm::test
