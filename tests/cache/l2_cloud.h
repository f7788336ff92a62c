// A tree of small chunks, to be cached.
#pragma once

#include "pcm/bpc/chunk_bytes.h"
#include "pcm/build/builder.h"
#include "pcm/cache/l2_cache.h"
#include "tests/clouds.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace pcm::test {

class L2CacheTest : public testing::Test {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::surface, 60000, 3), {});
        BuildOptions options;
        options.chunk_points = 1000;
        options.threads = 2;
        build_tree({folder_ / "in.las"}, folder_ / "out.pct", options);
        tree_ = Tree::open(folder_ / "out.pct");
        ASSERT_GT(tree_->nodes().size(), 60u);
        intensity_.attributes.set(*tree_->info().schema.find("intensity"));
        colour_.attributes.set(*tree_->info().schema.find("rgb"));
    }
    std::size_t bytes_of(NodeId node, const ColumnSet& columns) const
    {
        std::size_t bytes = (columns.positions ? 12 : 0) + (columns.sizes ? 1 : 0);
        for (std::size_t i = 0; i < tree_->info().schema.size(); ++i)
            if (columns.attributes.test(i)) bytes += tree_->info().schema[i].bytes();
        return bytes * tree_->node(node).points;
    }

    // Nodes with points that no read brings together, in the order of their chunks.
    std::vector<NodeId> nodes_read_apart(std::size_t count) const
    {
        std::map<std::uint64_t, NodeId> by_offset;
        for (NodeId id = 0; id < tree_->nodes().size(); ++id)
            if (tree_->node(id).extent.bytes > 0) by_offset[tree_->node(id).extent.offset] = id;
        std::vector<NodeId> nodes;
        std::uint64_t end = 0;
        for (const auto& [offset, id] : by_offset) {
            if (nodes.size() == count || (!nodes.empty() && offset <= end + join_gap)) continue;
            nodes.push_back(id);
            end = offset + tree_->node(id).extent.bytes;
        }
        EXPECT_EQ(nodes.size(), count);
        return nodes;
    }

    // Two nodes whose chunks one read brings.
    std::pair<NodeId, NodeId> nodes_read_together() const
    {
        for (NodeId a = 0; a < tree_->nodes().size(); ++a)
            for (NodeId b = 0; b < tree_->nodes().size(); ++b) {
                const Extent &first = tree_->node(a).extent, &second = tree_->node(b).extent;
                if (first.bytes && second.bytes && first.file == second.file &&
                    second.offset == first.offset + first.bytes)
                    return {a, b};
            }
        ADD_FAILURE() << "no two chunks lie next to each other";
        return {};
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    ColumnSet positions_ = ColumnSet::only_positions(), intensity_, colour_;
};

}  // namespace pcm::test
