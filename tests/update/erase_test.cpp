#include "pcm/update/erase.h"

#include "pcm/system/error.h"
#include "pcm/tree/tree_lock.h"
#include "tests/outcome.h"
#include "tests/sanitizers.h"
#include "tests/update/model.h"

#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

EraseOptions two_threads()
{
    EraseOptions options;
    options.threads = 2;
    return options;
}

Selection box_of(const Vec3d& min, const Vec3d& max)
{
    Selection selection;
    selection.box = Box3d{min, max};
    return selection;
}

Selection where(const std::string& condition)
{
    Selection selection;
    selection.where.push_back(parse_condition(condition));
    return selection;
}

class Erase : public testing::TestWithParam<Sampling> {
protected:
    Erase()
    {
        const MemoryCloud cloud = surface(40000, 0, 0, 100, 11);
        build(cloud, path_, GetParam());
        grid_ = Tree::open(path_)->info().grid;
        add(rows_, rows_of(cloud, grid_));
    }
    // Removes the rows for which `gone` returns true from the model; returns their number.
    template <class Gone>
    std::uint64_t model_erase(const Gone& gone)
    {
        const std::size_t before = rows_.size();
        rows_.erase(std::remove_if(rows_.begin(), rows_.end(), gone), rows_.end());
        return before - rows_.size();
    }
    const TemporaryFolder folder_;
    const fs::path path_ = folder_ / "tree.pct";
    Grid grid_;
    std::vector<Row> rows_;
};
INSTANTIATE_TEST_SUITE_P(Samplings, Erase, testing::Values(Sampling::poisson, Sampling::grid),
                         [](const auto& info) { return info.param == Sampling::poisson ? "poisson" : "grid"; });

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_P(Erase, PCM_NOT_UNDER_THREAD(BoxesAndConditionsAgainstAPlainList))
{
    std::mt19937_64 random(3);
    const auto any = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    for (int step = 0; step < 6 && !rows_.empty(); ++step) {
        Selection selection;
        const double x = any(-10, 90), y = any(-10, 90), width = any(1, 60);
        const bool by_box = step % 3 != 1, by_class = step % 3 != 0;
        const auto wanted = static_cast<unsigned char>(random() % 8);
        if (by_box) selection = box_of({1000 + x, 2000 + y, -1000}, {1000 + x + width, 2000 + y + width, 1000});
        if (by_class) selection.where.push_back(parse_condition("classification=" + std::to_string(wanted)));
        const std::uint64_t expected = model_erase([&](const Row& row) {
            const Vec3d p = grid_.to_source(row.q);
            return (!by_box || selection.box->contains(p)) &&
                   (!by_class || static_cast<unsigned char>(row.attributes.back()) == wanted);
        });
        EraseOptions count = two_threads();
        count.count_only = true;
        EXPECT_EQ(erase_points(path_, selection, count).points_deleted, expected);
        const Stopwatch watch;
        const EraseReport report = erase_points(path_, selection, two_threads());
        EXPECT_EQ(report.points_deleted, expected);
        expect_outcome(report.outcome, rows_.size() + expected, rows_.size(), watch);
        expect_tree(path_, rows_, "step " + std::to_string(step));
    }
}

// Every third point of the nodes with an even number.
class EveryThird final : public ChunkTest {
public:
    ColumnSet columns() const override
    {
        ColumnSet columns;
        columns.attributes.set(3);
        return columns;
    }
    bool touches(NodeId, const Node& node) const override { return node.depth < 3; }
    std::vector<std::uint32_t> chosen(NodeId node, const Chunk& chunk) const override
    {
        EXPECT_TRUE(chunk.positions && chunk.attributes[3]);
        std::vector<std::uint32_t> chosen;
        for (std::uint32_t i = 0; i < chunk.points && node % 2 == 0; i += 3) chosen.push_back(i);
        return chosen;
    }
};

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_P(Erase, PCM_NOT_UNDER_THREAD(PointsChosenByATestOfEachChunk))
{
    const MakeChunkTest make = [&](const std::shared_ptr<const Tree>& tree) {
        EXPECT_EQ(tree->info().points, rows_.size());
        return std::make_unique<EveryThird>();
    };
    std::vector<Row> kept;
    const auto before = Tree::open(path_);
    for (NodeId id = 0; id < before->nodes().size(); ++id) {
        const Chunk chunk = before->read_chunk(id, ColumnSet::all(before->info().schema));
        for (std::uint32_t i = 0; i < chunk.points; ++i) {
            if (before->node(id).depth < 3 && id % 2 == 0 && i % 3 == 0) continue;
            Row row{chunk.positions->grid(i), {}};
            for (const auto& column : chunk.attributes) row.attributes += bytes_of(*column, i);
            kept.push_back(std::move(row));
        }
    }
    std::sort(kept.begin(), kept.end());
    ASSERT_LT(kept.size(), rows_.size());
    EraseOptions options = two_threads();
    options.count_only = true;
    EXPECT_EQ(erase_points(path_, make, options).points_deleted, rows_.size() - kept.size());
    options.count_only = false;
    std::vector<double> fractions;
    options.begin = 0.5;
    options.progress = [&](const ProgressUpdate& update) { return fractions.push_back(update.fraction), true; };
    EXPECT_EQ(erase_points(path_, make, options).points_deleted, rows_.size() - kept.size());
    expect_tree(path_, kept, "every third");
    ASSERT_FALSE(fractions.empty());
    EXPECT_GE(fractions.front(), 0.5);
}

TEST_P(Erase, NodesOutsideStayWhereTheyAre)
{
    const auto before = Tree::open(path_);
    const EraseReport report = erase_points(path_, box_of({1000, 2000, -1000}, {1010, 2010, 1000}), two_threads());
    EXPECT_GT(report.points_deleted, 0u);
    const auto after = Tree::open(path_);
    std::size_t same = 0;
    for (const Node& node : after->nodes())
        for (const Node& old : before->nodes()) same += node.extent.bytes && node.extent == old.extent;
    EXPECT_EQ(
        same + report.nodes_rewritten + report.nodes_emptied,
        std::count_if(before->nodes().begin(), before->nodes().end(), [](const Node& n) { return n.points > 0; }));
    EXPECT_GT(same, 10u);
    EXPECT_EQ(after->info().generation, 2u);
    // Open readers keep reading the old tree.
    EXPECT_EQ(rows_of(*before), rows_);
}

TEST_P(Erase, OnlyPointsOfTheLastLevelKeepsTheCoverage)
{
    // Points deleted one at a time, by their time stamp, which is random.
    const auto tree = Tree::open(path_);
    const std::size_t rest = tree->info().levels - 1u;
    ASSERT_EQ(tree->info().spacings[rest], 0);
    bool kept = true;
    std::uint32_t point = 0;
    // What the third deletion keeps the second has lost already.
    for (const bool of_the_rest : {true, false, true}) {
        std::string condition;
        for (NodeId id = 0; id < tree->nodes().size() && condition.empty(); ++id) {
            const Node& node = tree->node(id);
            if (node.points == 0 || (node.first_level == rest) != of_the_rest) continue;
            const Chunk chunk = tree->read_chunk(id, ColumnSet::all(tree->info().schema));
            char text[64];
            std::snprintf(text, sizeof text, "gps_time=%.17g", chunk.attributes[2]->value(point));
            condition = text;
        }
        ++point;
        kept = kept && of_the_rest;
        const EraseReport report = erase_points(path_, where(condition), two_threads());
        EXPECT_EQ(report.points_deleted, 1u) << condition;
        EXPECT_EQ(report.coverage_kept, of_the_rest);
        EXPECT_EQ(Tree::open(path_)->info().coverage_kept, kept);
    }
}

TEST_P(Erase, Everything)
{
    const EraseReport report = erase_points(path_, where("x>=-1e9"), two_threads());
    EXPECT_EQ(report.points_deleted, 40000u);
    expect_tree(path_, {}, "empty");
    EXPECT_EQ(erase_points(path_, where("x>=-1e9"), two_threads()).points_deleted, 0u);
    EXPECT_EQ(Tree::open(path_)->info().content_hash, 0u);
}

TEST_P(Erase, NothingChangesNothing)
{
    const EraseReport report = erase_points(path_, box_of({0, 0, 0}, {1, 1, 1}), two_threads());
    EXPECT_EQ(report.points_deleted, 0u);
    EXPECT_EQ(Tree::open(path_)->info().generation, 1u);
    EXPECT_FALSE(fs::exists(path_ / "chunks-002.bpc"));
}

TEST_P(Erase, RefusesWhatItCannotDo)
{
    const auto code = [&](const Selection& selection) {
        try {
            erase_points(path_, selection, two_threads());
        } catch (const Error& error) {
            return error.code();
        }
        return ErrorCode::cancelled;
    };
    EXPECT_EQ(code({}), ErrorCode::invalid_argument);
    EXPECT_EQ(code(where("colour=3")), ErrorCode::invalid_argument);
    {
        const TreeLock lock(path_);
        EXPECT_EQ(code(where("x>0")), ErrorCode::exists);
    }
    EraseOptions cancelled = two_threads();
    cancelled.progress = [](const ProgressUpdate&) { return false; };
    EXPECT_THROW(erase_points(path_, where("classification=1"), cancelled), Error);
    expect_tree(path_, rows_, "after refusals");
    EXPECT_EQ(Tree::open(path_)->info().generation, 1u);
}

// Positions of float sources are compared as readers give them.
TEST(EraseFloats, BoxesThatEndAtPoints)
{
    const TemporaryFolder folder;
    Schema schema;
    MemoryCloud cloud = random_cloud(schema, std::nullopt, 5000, 5);
    cloud.info.position_type = ScalarType::f32;
    for (auto& axis : cloud.points.xyz)
        for (double& c : axis) c = static_cast<float>(c);
    build(cloud, folder / "tree.pct");
    const Vec3d p{cloud.points.xyz[0][100], cloud.points.xyz[1][100], cloud.points.xyz[2][100]};
    EXPECT_EQ(erase_points(folder / "tree.pct", box_of(p, p), two_threads()).points_deleted, 1u);
    std::vector<Row> rows = rows_of(cloud, Tree::open(folder / "tree.pct")->info().grid);
    rows.erase(rows.begin() + 100);
    std::sort(rows.begin(), rows.end());
    expect_tree(folder / "tree.pct", rows, "without one");
}

// Where no points are left, none is inexact: what the deleted ones lost by rounding is not reported of others.
TEST(EraseFloats, NoPointsHaveNoPositionError)
{
    const TemporaryFolder folder;
    const fs::path path = folder / "tree.pct";
    MemoryCloud cloud = random_cloud({}, std::nullopt, 3000, 6);
    // One far away: the grid has no digits for all of the others'.
    cloud.points.xyz[0][0] = 1e12;
    build(cloud, path);
    const double error = Tree::open(path)->info().position_error;
    ASSERT_GT(error, 0);
    erase_points(path, where("x<0"), two_threads());
    ASSERT_GT(Tree::open(path)->info().points, 0u);
    EXPECT_EQ(Tree::open(path)->info().position_error, error);  // the other points'
    erase_points(path, where("x>=-1e9"), two_threads());
    ASSERT_EQ(Tree::open(path)->info().points, 0u);
    EXPECT_EQ(Tree::open(path)->info().position_error, 0);
    EXPECT_EQ(verify_tree(path, 1).position_error, 0);
}

}  // namespace
