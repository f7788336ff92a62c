#include "pcm/update/append.h"

#include "pcm/system/error.h"
#include "pcm/tree/tree_lock.h"
#include "pcm/tree/tree_reader.h"
#include "tests/build/build_support.h"
#include "tests/outcome.h"
#include "tests/sanitizers.h"
#include "tests/update/model.h"

#include <cmath>
#include <fstream>
#include <map>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

class Append : public testing::TestWithParam<Sampling> {
protected:
    void start(const MemoryCloud& cloud)
    {
        build(cloud, path_, GetParam());
        grid_ = Tree::open(path_)->info().grid;
        add(rows_, rows_of(cloud, grid_));
    }
    void append_and_check(const MemoryCloud& cloud, const std::string& when)
    {
        const Stopwatch watch;
        const AppendReport report = append(path_, cloud);
        add(rows_, rows_of(cloud, grid_));
        EXPECT_EQ(report.points_added, cloud.points.size) << when;
        SCOPED_TRACE(when);
        expect_outcome(report.outcome, cloud.points.size, rows_.size(), watch);
        expect_tree(path_, rows_, when);
    }
    const TemporaryFolder folder_;
    const fs::path path_ = folder_ / "tree.pct";
    Grid grid_;
    std::vector<Row> rows_;
};
INSTANTIATE_TEST_SUITE_P(Samplings, Append, testing::Values(Sampling::poisson, Sampling::grid),
                         [](const auto& info) { return info.param == Sampling::poisson ? "poisson" : "grid"; });

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_P(Append, PCM_NOT_UNDER_THREAD(BesideAcrossAndOverTheExistingPoints))
{
    start(surface(20000, 0, 0, 50, 31));
    append_and_check(surface(15000, 50, 0, 50, 32), "next to it");
    append_and_check(surface(10000, 30, 20, 50, 33), "across the border");
    append_and_check(surface(20000, 0, 0, 50, 34), "all over");
    append_and_check(surface(500, -200, -200, 700, 35), "few and far");
    append_and_check(surface(1, 10, 10, 1, 36), "one");
    const auto tree = Tree::open(path_);
    EXPECT_EQ(tree->info().generation, 6u);
    EXPECT_EQ(tree->part_roots().size(), 6u);
    EXPECT_EQ(tree->info().sources.size(), 6u);
}

// A denser tile, so that many of its points are near to chosen ones of fine levels.
TEST_P(Append, DenseOntoSparse)
{
    start(surface(3000, 0, 0, 100, 41));
    append_and_check(surface(40000, 40, 40, 20, 42), "dense");
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_P(Append, PCM_NOT_UNDER_THREAD(SparseOntoDense))
{
    start(surface(40000, 0, 0, 30, 43));
    append_and_check(surface(2000, -50, -50, 130, 44), "sparse");
}

TEST_P(Append, TheSamePointsAgain)
{
    const MemoryCloud cloud = surface(8000, 0, 0, 40, 45);
    start(cloud);
    append_and_check(cloud, "again");
    // The tree itself as the cloud.
    const auto tree = Tree::open(path_);
    TreeReader reader(tree, std::nullopt, {});
    EXPECT_EQ(append_points(path_, reader, {"tree.pct"}, small_append()).points_added, 16000u);
    add(rows_, std::vector<Row>(rows_));
    expect_tree(path_, rows_, "doubled");
}

TEST_P(Append, ToATreeOfFewPoints)
{
    start(surface(2, 0, 0, 40, 46));
    append_and_check(surface(5000, 0, 0, 40, 47), "many");
}

TEST_P(Append, ToAnEmptyTree)
{
    start(surface(0, 0, 0, 40, 48));
    append_and_check(surface(5000, 0, 0, 40, 49), "first points");
    append_and_check(surface(5000, 20, 0, 40, 50), "more");
}

TEST_P(Append, NothingIsNoChange)
{
    start(surface(3000, 0, 0, 40, 51));
    EXPECT_EQ(append(path_, surface(0, 0, 0, 1, 52)).points_added, 0u);
    EXPECT_EQ(Tree::open(path_)->info().generation, 1u);
    expect_tree(path_, rows_, "nothing");
}

TEST_P(Append, SameBytesForAnyNumberOfThreads)
{
    const MemoryCloud first = surface(tries(60000, 20000), 0, 0, 100, 53),
                      second = surface(tries(150000, 50000), 50, 50, 100, 54);
    std::map<std::string, std::string> expected;
    for (const unsigned threads : {1u, 2u, 5u}) {
        build(first, path_, GetParam());
        append(path_, second, small_append(threads));
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::directory_iterator(path_)) {
            std::ifstream file(entry.path(), std::ios::binary);
            files[entry.path().filename()] = std::string(std::istreambuf_iterator<char>(file), {});
        }
        if (expected.empty()) expected = files;
        EXPECT_TRUE(files == expected) << threads << " threads";
    }
}

TEST_P(Append, OtherAttributes)
{
    start(surface(3000, 0, 0, 40, 55));
    // One is missing.
    MemoryCloud less = surface(2000, 20, 0, 40, 56);
    Schema schema;
    for (const Attribute& attribute : less.info.schema)
        if (attribute.name != "rgb") schema.add(attribute);
    less.info.schema = schema;
    less.points.attributes.erase(less.points.attributes.begin() + 1);
    const AppendReport report = append(path_, less);
    ASSERT_EQ(report.notes.size(), 1u);
    EXPECT_NE(report.notes[0].find("rgb"), std::string::npos);
    std::vector<Row> rows = rows_of(less, grid_);
    for (Row& row : rows) row.attributes.insert(2, 3, '\0');
    add(rows_, rows);
    expect_tree(path_, rows_, "without colours");
    // One is new.
    MemoryCloud more = surface(10, 0, 0, 40, 57);
    more.info.schema.add({"reflectance", ScalarType::f32, 1, 1, 0, ""});
    more.points.attributes.emplace_back(ScalarType::f32, 1);
    more.points.attributes.back().resize(10);
    EXPECT_THROW(append(path_, more), Error);
    expect_tree(path_, rows_, "after the refusal");
}

TEST_P(Append, CancelledAndRefusedLeaveTheTree)
{
    start(surface(3000, 0, 0, 40, 58));
    const MemoryCloud cloud = surface(3000, 10, 0, 40, 59);
    {
        const TreeLock lock(path_);
        EXPECT_THROW(append(path_, cloud), Error);
    }
    AppendOptions cancelled = small_append();
    cancelled.progress = [](const ProgressUpdate& update) { return update.fraction < 1; };
    EXPECT_THROW(append(path_, cloud, cancelled), Error);
    MemoryCloud off = cloud;
    off.info.grid->scale[0] = 0.003;
    EXPECT_THROW(append(path_, off), Error);
    AppendOptions tiny = small_append();
    tiny.memory_bytes = 1 << 20;
    EXPECT_THROW(append(path_, cloud, tiny), Error);
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(path_)) {
        const std::string name = entry.path().filename();
        EXPECT_TRUE(name == "index.pct" || name == "about.pct" || name == "lock" || name == "chunks-000.bpc" ||
                    name == "chunks-001.bpc")
            << name;
        ++files;
    }
    EXPECT_LE(files, 5u);
    expect_tree(path_, rows_, "after all");
}

// Neither the memory nor the number of threads changes a byte of the new part.
TEST_P(Append, SameBytesForAnyMemoryAndNumberOfThreads)
{
    const MemoryCloud before = surface(5000, 0, 0, 40, 64), more = surface(tries(60000, 20000), 10, 0, 40, 65);
    Contents first;
    for (const auto& [megabytes, threads] : {std::pair<std::uint64_t, unsigned>{64, 1}, {64, 7}, {4096, 3}}) {
        build(before, path_, GetParam());
        AppendOptions options = small_append(threads);
        options.memory_bytes = megabytes << 20;
        append(path_, more, options);
        const Contents files = contents(path_);
        if (first.empty()) first = files;
        EXPECT_TRUE(files == first) << megabytes << " MiB, " << threads << " threads";
    }
}

// Positions in double, on a grid of 64 bits.
// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST(AppendFloats, PCM_NOT_UNDER_THREAD(KeepEveryPosition))
{
    const TemporaryFolder folder;
    for (const Sampling sampling : {Sampling::poisson, Sampling::grid}) {
        const MemoryCloud first = random_cloud(test_schema(), std::nullopt, 6000, 61),
                          second = random_cloud(test_schema(), std::nullopt, 5000, 62, 400);
        build(first, folder / "tree.pct", sampling);
        append(folder / "tree.pct", second);
        const Grid grid = Tree::open(folder / "tree.pct")->info().grid;
        std::vector<Row> rows;
        add(rows, rows_of(first, grid));
        add(rows, rows_of(second, grid));
        expect_tree(folder / "tree.pct", rows, "floats");
        EXPECT_THROW(append(folder / "tree.pct", random_cloud({}, std::nullopt, 100, 63, 1e7)), Error);
    }
}

}  // namespace
