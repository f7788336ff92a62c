#include "pcm/update/repair.h"

#include "pcm/bpc/chunk_encoder.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "pcm/update/erase.h"
#include "pcm/update/tree_changes.h"
#include "tests/outcome.h"
#include "tests/update/model.h"

#include <fstream>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

std::string bytes_of_file(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

void overwrite(const fs::path& path, std::uint64_t at, const std::string& bytes)
{
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(at));
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void erase_class(const fs::path& tree, int number)
{
    Selection selection;
    selection.where.push_back(parse_condition("classification=" + std::to_string(number)));
    EraseOptions options;
    options.threads = 2;
    erase_points(tree, selection, options);
}

RepairOptions options_of(bool check_only = false)
{
    RepairOptions options;
    options.threads = 2;
    options.check_only = check_only;
    return options;
}

class RepairTest : public testing::TestWithParam<Sampling> {
protected:
    RepairTest()
    {
        const MemoryCloud cloud = surface(30000, 0, 0, 100, 21);
        build(cloud, path_, GetParam());
        add(rows_, rows_of(cloud, Tree::open(path_)->info().grid));
    }
    const TemporaryFolder folder_;
    const fs::path path_ = folder_ / "tree.pct", index_ = path_ / index_file_name;
    std::vector<Row> rows_;
};
INSTANTIATE_TEST_SUITE_P(Samplings, RepairTest, testing::Values(Sampling::poisson, Sampling::grid),
                         [](const auto& info) { return info.param == Sampling::poisson ? "poisson" : "grid"; });

TEST_P(RepairTest, AWholeTreeStays)
{
    const std::string before = bytes_of_file(index_);
    const Stopwatch watch;
    const RepairReport report = repair_tree(path_, options_of());
    EXPECT_TRUE(report.whole());
    expect_outcome(report.outcome, 30000, 30000, watch);
    EXPECT_TRUE(report.healed.empty() && report.restored.empty());
    EXPECT_EQ(bytes_of_file(index_), before);
}

TEST_P(RepairTest, ALostIndexComesBackToTheByte)
{
    for (int step = 0; step < 4; ++step) {
        if (step) erase_class(path_, step);
        const std::string before = bytes_of_file(index_);
        fs::remove(index_);
        const RepairReport checked = repair_tree(path_, options_of(true));
        EXPECT_TRUE(checked.index_written);
        EXPECT_FALSE(fs::exists(index_));
        const RepairReport report = repair_tree(path_, options_of());
        EXPECT_EQ(report.points_lost, 0u);
        EXPECT_EQ(report.faults.size(), 1u) << report.faults.back();  // the missing index
        EXPECT_TRUE(bytes_of_file(index_) == before) << "step " << step;
    }
}

TEST_P(RepairTest, ADamagedIndexIsKept)
{
    const std::string before = bytes_of_file(index_);
    overwrite(index_, 300, "damage");
    const std::string damaged = bytes_of_file(index_);
    EXPECT_THROW(Tree::open(path_), Error);
    repair_tree(path_, options_of());
    EXPECT_TRUE(bytes_of_file(index_) == before);
    EXPECT_TRUE(bytes_of_file(path_ / damaged_index_name) == damaged);
}

TEST_P(RepairTest, DamagedChunksAreLeftOutAndReported)
{
    const auto tree = Tree::open(path_);
    std::uint64_t lost = 0;
    std::vector<NodeId> leaves;
    for (NodeId id = 0; id < tree->nodes().size(); ++id)
        if (tree->node(id).is_leaf()) leaves.push_back(id);
    ASSERT_GT(leaves.size(), 4u);
    // One in its columns, one in its header.
    for (const bool header : {false, true}) {
        const Node& node = tree->node(leaves[header ? 1 : 3]);
        lost += node.points;
        const Extent& extent = node.extent;
        char name[32];
        std::snprintf(name, sizeof name, "chunks-%03u.bpc", extent.file);
        overwrite(path_ / name, extent.offset + (header ? 10 : extent.bytes - 20), "damaged!");
    }
    const RepairReport report = repair_tree(path_, options_of());
    EXPECT_EQ(report.points_lost, lost);
    EXPECT_EQ(report.faults.size(), 2u);
    const auto repaired = Tree::open(path_);
    EXPECT_EQ(repaired->info().points, 30000 - lost);
    EXPECT_FALSE(repaired->info().coverage_kept);
    const VerifyReport verified = verify_tree(path_, 1);
    EXPECT_TRUE(verified.faults.empty()) << verified.faults.front();
    const std::vector<Row> left = rows_of(*repaired);
    EXPECT_TRUE(std::includes(rows_.begin(), rows_.end(), left.begin(), left.end()));
    EXPECT_TRUE(repair_tree(path_, options_of()).whole());
}

// Its chunk says how far its points are apart, and is valid still.
TEST_P(RepairTest, ANodeWhoseChildrenAreLostBecomesALeaf)
{
    const auto tree = Tree::open(path_);
    const NodeTable& nodes = tree->nodes();
    // The lowest node with points that has some below.
    NodeId above = no_node;
    for (NodeId id = 0; id < nodes.size(); ++id)
        if (nodes[id].points && !nodes[id].is_leaf() && nodes[id].spacing > 0) above = id;
    ASSERT_NE(above, no_node);
    std::uint64_t lost = 0;
    std::vector<NodeId> below(nodes[above].children.begin(), nodes[above].children.end());
    for (std::size_t i = 0; i < below.size(); ++i) {
        if (below[i] == no_node) continue;
        const Node& node = nodes[below[i]];
        below.insert(below.end(), node.children.begin(), node.children.end());
        if (nodes[below[i]].points == 0) continue;
        const Extent extent = nodes[below[i]].extent;
        lost += nodes[below[i]].points;
        char name[32];
        std::snprintf(name, sizeof name, "chunks-%03u.bpc", extent.file);
        overwrite(path_ / name, extent.offset + extent.bytes - 20, "damaged!");
    }
    EXPECT_EQ(repair_tree(path_, options_of()).points_lost, lost);
    const auto repaired = Tree::open(path_);
    EXPECT_EQ(rows_of(*repaired).size(), 30000 - lost);
    const VerifyReport verified = verify_tree(path_, 1);
    EXPECT_TRUE(verified.faults.empty()) << verified.faults.front();
    bool found = false;
    for (const Node& node : repaired->nodes())
        found = found || (node.is_leaf() && node.points == nodes[above].points && node.spacing == nodes[above].spacing);
    EXPECT_TRUE(found);
}

TEST_P(RepairTest, ATruncatedDataFile)
{
    const fs::path file = path_ / "chunks-000.bpc";
    fs::resize_file(file, fs::file_size(file) / 2);
    EXPECT_THROW(Tree::open(path_), Error);
    const Stopwatch watch;
    const RepairReport report = repair_tree(path_, options_of());
    EXPECT_GT(report.points_lost, 0u);
    expect_outcome(report.outcome, 30000, 30000 - report.points_lost, watch);
    EXPECT_TRUE(verify_tree(path_, 1).faults.empty());
    // Nothing is not put in the place of something.
    fs::remove(file);
    const std::string before = bytes_of_file(index_);
    EXPECT_THROW(repair_tree(path_, options_of()), Error);
    EXPECT_TRUE(bytes_of_file(index_) == before);
}

TEST_P(RepairTest, WithoutIndexAndAbout)
{
    erase_class(path_, 3);
    rows_.erase(std::remove_if(rows_.begin(), rows_.end(), [](const Row& row) { return row.attributes.back() == 3; }),
                rows_.end());
    const auto before = Tree::open(path_);
    fs::remove(index_);
    fs::remove(path_ / about_file_name);
    const RepairReport report = repair_tree(path_, options_of());
    EXPECT_EQ(report.points_lost, 0u);
    EXPECT_EQ(report.faults.size(), 2u);
    expect_tree(path_, rows_, "without about");
    const auto after = Tree::open(path_);
    EXPECT_EQ(after->info().content_hash, before->info().content_hash);
    EXPECT_EQ(after->info().spacings, before->info().spacings);
    ASSERT_EQ(after->nodes().size(), before->nodes().size());
    for (NodeId id = 0; id < after->nodes().size(); ++id) EXPECT_EQ(after->node(id).extent, before->node(id).extent);
}

TEST_P(RepairTest, LeftoversOfAnInterruptedUpdate)
{
    const std::string before = bytes_of_file(index_), about = bytes_of_file(path_ / about_file_name);
    erase_class(path_, 2);
    // As if the process had been killed before it replaced the index.
    std::ofstream(index_, std::ios::binary | std::ios::trunc) << before;
    ASSERT_EQ(Tree::open(path_)->info().generation, 1u);
    const RepairReport checked = repair_tree(path_, options_of(true));
    EXPECT_EQ(checked.healed.size(), 1u);
    const RepairReport report = repair_tree(path_, options_of());
    EXPECT_TRUE(report.whole());
    EXPECT_EQ(report.healed, checked.healed);
    EXPECT_FALSE(fs::exists(path_ / report.healed.at(0)));
    EXPECT_TRUE(bytes_of_file(path_ / about_file_name) == about);
    expect_tree(path_, rows_, "healed");
}

TEST_P(RepairTest, AnUnfinishedGenerationIsNotTaken)
{
    const std::string before = bytes_of_file(index_), about = bytes_of_file(path_ / about_file_name);
    const auto files = static_cast<std::uint32_t>(Tree::open(path_)->data_files().size());
    erase_class(path_, 2);
    // Killed before the commit record, and the index lost later.
    char name[32];
    std::snprintf(name, sizeof name, "chunks-%03u.bpc", files);
    fs::resize_file(path_ / name, fs::file_size(path_ / name) - 60);
    std::ofstream(path_ / about_file_name, std::ios::binary | std::ios::trunc) << about;
    fs::remove(index_);
    repair_tree(path_, options_of());
    EXPECT_TRUE(bytes_of_file(index_) == before);
    EXPECT_FALSE(fs::exists(path_ / name));
}

// A cache that writes a chunk, reads it again and changes it once more leaves both in one generation.
TEST_P(RepairTest, OfTwoChunksOfOneGenerationTheLaterOneCounts)
{
    for (const bool other_file : {false, true}) {
        TreeChanges changes(path_);
        NodeId node = 0;
        while (changes.tree()->node(node).points == 0) ++node;
        for (const std::uint16_t value : {std::uint16_t(7), std::uint16_t(9)}) {
            Chunk chunk = changes.read(node, ColumnSet::all(changes.tree()->info().schema));
            const auto column = std::make_shared<Column>(*chunk.attributes[0]);
            std::fill_n(column->as<std::uint16_t>(), column->size(), value);
            chunk.attributes[0] = column;
            ColumnSet changed;
            changed.attributes.set(0);
            changes.write(node, chunk, changed);
            if (other_file && value == 7) changes.add_attribute({"height", ScalarType::f32, 1, 1, 0, ""});
        }
        changes.commit();
        changes.end();
        const std::string before = bytes_of_file(index_);
        const std::uint64_t hash = Tree::open(path_)->info().content_hash;
        fs::remove(index_);
        const RepairReport report = repair_tree(path_, options_of());
        EXPECT_EQ(report.points_lost, 0u);
        EXPECT_TRUE(report.verified);
        EXPECT_GT(Tree::open(path_)->info().generation, other_file ? 2u : 1u);
        EXPECT_TRUE(bytes_of_file(index_) == before) << other_file;
        EXPECT_EQ(Tree::open(path_)->info().content_hash, hash) << other_file;
    }
}

// Chunks with matching checksums and values that no tree's chunk has.
TEST_P(RepairTest, ImpossibleNumbersAreDamage)
{
    const std::string before = bytes_of_file(index_);
    const auto tree = Tree::open(path_);
    const Schema& schema = tree->info().schema;
    const Chunk chunk = tree->read_chunk(0, ColumnSet::all(schema));
    std::ofstream file(path_ / "chunks-000.bpc", std::ios::binary | std::ios::app);
    for (const int kind : {0, 1, 2}) {
        ChunkIdentity identity = tree->identity(0);
        if (kind == 0) identity.part = 0xffffffff;
        if (kind == 1) identity.part = 0x7fffffff;
        if (kind == 2) identity.generation = 0xfffffff0;
        const auto bytes = encode_chunk(chunk, schema, tree->info().grid, identity);
        file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    file.close();
    std::ofstream(path_ / "chunks-4000000000.bpc") << "BPC1";
    fs::remove(index_);
    const RepairReport report = repair_tree(path_, options_of());
    EXPECT_EQ(report.points_lost, 0u);
    EXPECT_EQ(report.faults.size(), 2u);
    EXPECT_TRUE(bytes_of_file(index_) == before);
}

TEST(Repair, RefusesWhatIsNoTree)
{
    const TemporaryFolder folder;
    EXPECT_THROW(repair_tree(folder.path(), options_of()), Error);
    EXPECT_THROW(repair_tree(folder / "none", options_of()), Error);
    std::ofstream(folder / "chunks-000.bpc") << std::string(100000, 'B') << "BPC1" << std::string(5000, '\3');
    EXPECT_THROW(repair_tree(folder.path(), options_of()), Error);
    EXPECT_FALSE(fs::exists(folder / index_file_name));
}

}  // namespace
