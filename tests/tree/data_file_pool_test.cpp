#include "pcm/tree/data_file_pool.h"

#include "pcm/system/error.h"
#include "pcm/tree/damage.h"
#include "pcm/tree/verify.h"
#include "tests/tree/small_tree.h"

#include <algorithm>
#include <atomic>
#include <random>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class DataFilePoolTest : public SmallTree {
protected:
    // Every chunk into a data file of its own.
    std::size_t scatter() const
    {
        TreeIndex index = this->index();
        std::vector<std::vector<std::byte>> files;
        for (std::uint32_t i = 0; i < index.data_files.size(); ++i)
            files.push_back(read_file(tree() / data_file_name(i)));
        std::vector<DataFile> data_files;
        for (Node& node : index.nodes) {
            if (!node.extent.bytes) continue;
            const auto from = files[node.extent.file].begin() + static_cast<std::ptrdiff_t>(node.extent.offset);
            node.extent.file = static_cast<std::uint32_t>(data_files.size());
            node.extent.offset = 0;
            write_file(tree() / data_file_name(node.extent.file),
                       {from, from + static_cast<std::ptrdiff_t>(node.extent.bytes)});
            data_files.push_back({node.extent.bytes, 1});
        }
        index.data_files = std::move(data_files);
        write_index(index);
        return index.data_files.size();
    }
};

TEST_F(DataFilePoolTest, ManyDataFilesKeepFewOpen)
{
    build(200000, 1000);
    const std::size_t files = scatter();
    ASSERT_GT(files, 150u);
    const std::size_t before = open_descriptors();
    std::atomic<std::uint64_t> points{0};
    std::atomic<bool> failed{false};
    std::size_t after = 0;
    {
        const LimitedDescriptors limit(16);
        const auto tree = Tree::open(this->tree(), 8);
        std::vector<std::thread> crew;
        for (unsigned t = 0; t < 4; ++t)
            crew.emplace_back([&, t] {
                try {
                    std::mt19937_64 random(t);
                    const std::size_t nodes = tree->nodes().size();
                    for (std::size_t i = t; i < nodes; i += 4) {
                        points += tree->read_chunk(static_cast<NodeId>(i), ColumnSet::only_positions()).points;
                        tree->read_chunk(static_cast<NodeId>(random() % nodes), ColumnSet::only_positions());
                    }
                } catch (const std::exception&) {
                    failed = true;
                }
            });
        for (std::thread& thread : crew) thread.join();
        after = open_descriptors();
        EXPECT_EQ(points, tree->info().points);
    }
    EXPECT_FALSE(failed);
    EXPECT_LE(after, before + 8);
    EXPECT_EQ(open_descriptors(), before);
    EXPECT_TRUE(verify_tree(tree(), 2).faults.empty());
}

// A tree that opens its files when they are used may have lost one: the others are read, and it is named.
TEST_F(DataFilePoolTest, AFileThatIsGoneOrTooShortIsNamedWhenItIsUsed)
{
    build(100000, 1000);
    scatter();
    const auto node_in = [&](const Tree& tree, std::uint32_t file) {
        NodeId id = 0;
        while (tree.node(id).extent.bytes == 0 || tree.node(id).extent.file != file) ++id;
        return id;
    };
    fs::remove(tree() / data_file_name(40));
    const auto whole = read_file(tree() / data_file_name(50));
    write_file(tree() / data_file_name(50), std::vector<std::byte>(whole.begin(), whole.end() - 1));
    EXPECT_THROW(Tree::open(tree(), 100000), DamagedTree);
    const auto opened = Tree::open(tree(), 8);
    EXPECT_GT(opened->read_chunk(node_in(*opened, 41), ColumnSet::only_positions()).points, 0u);
    try {
        opened->read_chunk(node_in(*opened, 40), ColumnSet::only_positions());
        ADD_FAILURE() << "read";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::not_found) << error.what();
        EXPECT_NE(std::string(error.what()).find(data_file_name(40)), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("open it again"), std::string::npos) << error.what();
    }
    try {
        opened->read_chunk(node_in(*opened, 50), ColumnSet::only_positions());
        ADD_FAILURE() << "read";
    } catch (const DamagedTree& error) {
        EXPECT_EQ(error.code(), ErrorCode::truncated) << error.what();
    }
    EXPECT_THROW(check_data_files(tree(), opened->data_files()), Error);
    const VerifyReport report = verify_tree(tree(), 1);
    ASSERT_EQ(report.faults.size(), 2u);
    EXPECT_NE(report.faults[0].find(data_file_name(40)), std::string::npos) << report.faults[0];
    EXPECT_NE(report.faults[1].find(data_file_name(50)), std::string::npos) << report.faults[1];
}

// After many calls the pool holds the files used last.
TEST_F(DataFilePoolTest, ThePoolClosesWhatWasNotUsedForLongest)
{
    std::vector<DataFile> files;
    for (std::uint32_t i = 0; i < 12; ++i) {
        write_file(folder_ / data_file_name(i), {std::byte(i)});
        files.push_back({1, 1});
    }
    files.push_back({0, 1});  // no such file, and none is needed
    DataFilePool pool(folder_.path(), files, 4);
    std::mt19937_64 random(1);
    std::vector<std::uint32_t> used;  // naive model, last used first
    std::vector<std::weak_ptr<const ByteSource>> seen(12);
    for (int round = 0; round < 2000; ++round) {
        const auto number = static_cast<std::uint32_t>(random() % 12);
        const bool was_open = !seen[number].expired();
        const auto it = std::find(used.begin(), used.end(), number);
        ASSERT_EQ(was_open, it != used.end()) << round;
        if (it != used.end()) used.erase(it);
        used.insert(used.begin(), number);
        if (used.size() > 4) used.pop_back();
        const auto file = pool.get(number);
        seen[number] = file;
        std::byte first;
        file->read_at(&first, 1, 0);
        ASSERT_EQ(first, std::byte(number));
        ASSERT_EQ(pool.open_files(), used.size());
    }
}

}  // namespace
