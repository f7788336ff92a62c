// Chunks that are read while they change: whole and in parts, before and after they were written.
#include "pcm/update/tree_changes.h"

#include "pcm/system/error.h"
#include "tests/update/model.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

class TreeChangesTest : public testing::Test {
protected:
    void SetUp() override
    {
        Schema schema;
        schema.add({"intensity", ScalarType::u16, 1, 1, 0, {}});
        schema.add({"gps_time", ScalarType::f64, 1, 1, 0, {}});
        MemoryCloud cloud = random_cloud(schema, std::nullopt, 40000, 5, 100);
        MemoryReader reader(cloud);
        BuildOptions options;
        options.chunk_points = 12000;  // several segments
        options.memory_bytes = 64 << 20;
        build_tree(reader, {"memory"}, path_, options);
    }

    // The same part of the chunk, point for point, whatever of it is wanted.
    static void expect_parts(const TreeChanges& changes, NodeId node, const ColumnSet& columns)
    {
        const Chunk whole = changes.read(node, columns);
        const std::vector<std::function<bool(const Box3i&, std::uint16_t)>> wishes{
            [](const Box3i&, std::uint16_t) { return true; }, [](const Box3i&, std::uint16_t) { return false; },
            [&](const Box3i& box, std::uint16_t) {
                return box.min[0] <
                       changes.tree()->node(node).box.min[0] / 2 + changes.tree()->node(node).box.max[0] / 2;
            }};
        for (std::size_t w = 0; w < wishes.size(); ++w) {
            const ChunkPart part = changes.read_part(node, columns, wishes[w]);
            std::size_t at = 0;
            for (std::size_t s = 0; s < part.first.size(); ++s)
                for (std::uint32_t i = part.first[s]; i < part.first[s] + part.count[s]; ++i, ++at) {
                    ASSERT_EQ(part.chunk.positions->grid(at), whole.positions->grid(i));
                    for (std::size_t k = 0; k < whole.attributes.size(); ++k) {
                        ASSERT_EQ(part.chunk.attributes[k] != nullptr, whole.attributes[k] != nullptr);
                        if (whole.attributes[k])
                            ASSERT_EQ(bytes_of(*part.chunk.attributes[k], at), bytes_of(*whole.attributes[k], i));
                    }
                }
            EXPECT_EQ(at, part.chunk.points);
            if (w == 0) EXPECT_EQ(at, whole.points);
            if (w == 1) EXPECT_EQ(at, 0u);
            EXPECT_GT(part.bytes_read, 0u);
        }
    }

    static Chunk with_intensity(Chunk chunk, std::uint16_t value)
    {
        auto column = std::make_shared<Column>(*chunk.attributes[0]);
        std::fill_n(column->as<std::uint16_t>(), chunk.points, value);
        chunk.attributes[0] = column;
        return chunk;
    }

    TemporaryFolder folder_;
    const std::filesystem::path path_ = folder_ / "t.pct";
};

TEST_F(TreeChangesTest, PartsAreThoseOfTheChunkAsItWasLastWritten)
{
    TreeChanges changes(path_);
    const ColumnSet all = ColumnSet::all(changes.tree()->info().schema);
    const std::size_t nodes = changes.tree()->nodes().size();
    ASSERT_GT(nodes, 3u);
    ColumnSet intensity;
    intensity.attributes.set(0);
    const auto expect_all = [&] {
        for (NodeId node = 0; node < nodes; ++node) {
            if (changes.tree()->node(node).points == 0) continue;
            expect_parts(changes, node, all);
            expect_parts(changes, node, ColumnSet::only_positions());
        }
    };
    expect_all();
    for (const std::uint16_t value : {7, 8}) {  // twice the same chunks
        for (NodeId node = 0; node < nodes; node += 2)
            if (changes.tree()->node(node).points)
                changes.write(node, with_intensity(changes.read(node, all), value), intensity);
        expect_all();
        EXPECT_EQ(changes.read(0, all).attributes[0]->value(0), value);
        std::vector<ChunkRequest> requests;
        for (NodeId node = 0; node < nodes; ++node) requests.push_back({node, all});
        changes.read_many(requests, [&](std::size_t i, Chunk chunk, const std::exception_ptr& failure) {
            ASSERT_FALSE(failure);
            EXPECT_TRUE(chunk.points == 0 || (chunk.attributes[0]->value(0) == value) == (i % 2 == 0)) << i;
        });
    }
    EXPECT_NE(Tree::open(path_)->read_chunk(0, all).attributes[0]->value(0), 8) << "not yet committed";
    changes.commit();
    expect_all();
    EXPECT_EQ(Tree::open(path_)->read_chunk(0, all).attributes[0]->value(0), 8);
    EXPECT_TRUE(verify_tree(path_, 1).faults.empty());
}

// Random changes and commits against a value for each node.
TEST_F(TreeChangesTest, ManyCommitsFollowEachOther)
{
    std::mt19937_64 random(5);
    TreeChanges changes(path_);
    const ColumnSet all = ColumnSet::all(changes.tree()->info().schema);
    const std::uint64_t generation = changes.tree()->info().generation;
    std::vector<std::optional<std::uint16_t>> expected(changes.tree()->nodes().size());
    const auto expect_values = [&](const std::function<Chunk(NodeId)>& read) {
        for (NodeId node = 0; node < expected.size(); ++node) {
            if (!expected[node]) continue;
            const Chunk chunk = read(node);
            EXPECT_EQ(chunk.attributes[0]->value(0), *expected[node]) << node;
            EXPECT_EQ(chunk.attributes[0]->value(chunk.points - 1), *expected[node]) << node;
        }
    };
    for (unsigned round = 1; round <= 5; ++round) {
        for (NodeId node = 0; node < expected.size(); ++node) {
            if (changes.tree()->node(node).points == 0 || (node > 0 && random() % 3)) continue;
            expected[node] = static_cast<std::uint16_t>(random());
            changes.write(node, with_intensity(changes.read(node, all), *expected[node]), all);
        }
        expect_values([&](NodeId node) { return changes.read(node, all); });
        changes.commit();
        EXPECT_EQ(changes.tree()->info().generation, generation + round);
        expect_values([&](NodeId node) { return changes.read(node, all); });
        const auto tree = Tree::open(path_);
        EXPECT_EQ(tree->info().generation, generation + round);
        EXPECT_EQ(tree->info().content_hash, changes.tree()->info().content_hash);
        expect_values([&](NodeId node) { return tree->read_chunk(node, all); });
    }
    EXPECT_TRUE(verify_tree(path_, 1).faults.empty());
}

TEST_F(TreeChangesTest, AddedAttributesAreZeroUntilTheyAreWritten)
{
    TreeChanges changes(path_);
    const ColumnSet before = ColumnSet::all(changes.tree()->info().schema);
    changes.write(0, with_intensity(changes.read(0, before), 9), before);
    EXPECT_EQ(changes.add_attribute({"more", ScalarType::u8, 1, 1, 0, {}}), 2u);
    EXPECT_THROW(changes.add_attribute({"more", ScalarType::u8, 1, 1, 0, {}}), Error);
    const ColumnSet all = ColumnSet::all(changes.tree()->info().schema);
    for (NodeId node = 0; node < changes.tree()->nodes().size(); ++node) {
        if (changes.tree()->node(node).points == 0) continue;
        expect_parts(changes, node, all);
        const Chunk chunk = changes.read(node, all);
        for (std::uint32_t i = 0; i < chunk.points; i += 100) EXPECT_EQ(chunk.attributes[2]->value(i), 0);
    }
    changes.commit();
    EXPECT_EQ(Tree::open(path_)->info().schema.size(), 3u);
    EXPECT_TRUE(verify_tree(path_, 1).faults.empty());
}

TEST_F(TreeChangesTest, WhatWasClosedIsReadAsOfTheLastCommit)
{
    TreeChanges changes(path_);
    const ColumnSet all = ColumnSet::all(changes.tree()->info().schema);
    const Chunk old = changes.read(0, all);
    EXPECT_THROW(TreeChanges again(path_), Error) << "it holds the tree's lock";
    changes.write(0, with_intensity(old, 9), all);
    changes.end();
    EXPECT_NO_THROW(TreeChanges again(path_));
    EXPECT_EQ(changes.read(0, all).attributes[0]->value(0), old.attributes[0]->value(0));
    expect_parts(changes, 0, all);
    for (const std::function<void()>& call :
         std::vector<std::function<void()>>{[&] { changes.write(0, old, all); },
                                            [&] {
                                                changes.add_attribute({"more", ScalarType::u8, 1, 1, 0, {}});
                                            }})
        try {
            call();
            ADD_FAILURE() << "it was closed";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            EXPECT_NE(std::string(error.what()).find("this point cloud was closed (open it again)"), std::string::npos)
                << error.what();
        }
    changes.commit();  // nothing to commit
    EXPECT_EQ(Tree::open(path_)->read_chunk(0, all).attributes[0]->value(0), old.attributes[0]->value(0));
}

}  // namespace
