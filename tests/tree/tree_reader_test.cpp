// A tree that is read like a file, against the cloud that it was built from.

#include "pcm/tree/tree_reader.h"

#include "pcm/build/builder.h"
#include "pcm/io/pipe/selected_reader.h"
#include "pcm/system/error.h"
#include "pcm/tree/verify.h"
#include "tests/clouds.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <cmath>
#include <fstream>

namespace {

using namespace pcm;
using namespace pcm::test;

const Grid grid{{0.01, 0.01, 0.001}, {500000, 4800000, -3}};

BuildOptions small_chunks()
{
    BuildOptions options;
    options.chunk_points = 1000;
    options.memory_bytes = 64 << 20;
    options.threads = 2;
    return options;
}

Schema some_schema()
{
    Schema schema;
    schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
    schema.add({"rgb", ScalarType::u8, 3, 1, 0, ""});
    schema.add({"gps_time", ScalarType::f64, 1, 1, 0, ""});
    return schema;
}

// The points of a cloud as a sorted list of their bytes.
std::vector<std::string> sorted_points(const MemoryCloud& cloud)
{
    std::vector<std::string> points(cloud.points.size);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d p = position_of(cloud.points, cloud.info.grid, i);
        points[i].assign(reinterpret_cast<const char*>(p.data()), sizeof p);
        for (const Column& column : cloud.points.attributes) points[i] += bytes_of(column, i);
    }
    std::sort(points.begin(), points.end());
    return points;
}

class TreeReaderTest : public testing::TestWithParam<bool> {
protected:
    void SetUp() override
    {
        cloud_ = random_cloud(some_schema(), GetParam() ? std::optional<Grid>(grid) : std::nullopt, 20000, 9, 100);
        cloud_.info.metadata = {{"las.vlr/someone/7", {std::byte{1}, std::byte{2}}}};
        if (!GetParam())
            for (auto& axis : cloud_.points.xyz)
                for (double& c : axis) c = 4.8e6 + c;  // where doubles are coarser than the tree's grid
        MemoryReader reader(cloud_);
        build_tree(reader, {"memory"}, folder_ / "t.pct", small_chunks());
        tree_ = Tree::open(folder_ / "t.pct");
    }
    MemoryCloud read(const Selection& selection = {}, std::optional<std::uint16_t> level = {}, std::size_t batch = 700)
    {
        TreeReader reader(tree_, level, selection);
        EXPECT_EQ(reader.fraction_read(), reader.info().points ? 0 : 1);
        MemoryCloud result = read_all(reader, batch);
        EXPECT_EQ(reader.fraction_read(), 1);
        if (reader.info().points_known) EXPECT_EQ(reader.info().points, result.points.size);
        if (result.points.size) {
            EXPECT_TRUE(reader.info().promised_box);
            for (std::size_t i = 0; i < result.points.size; ++i)
                EXPECT_TRUE(reader.info().promised_box->contains(position_of(result.points, result.info.grid, i)));
        }
        return result;
    }
    MemoryCloud select(const Selection& selection)
    {
        SelectedReader reader(std::make_unique<MemoryReader>(cloud_), selection);
        return read_all(reader);
    }
    TemporaryFolder folder_;
    MemoryCloud cloud_;
    std::shared_ptr<const Tree> tree_;
};
INSTANTIATE_TEST_SUITE_P(GriddedAndDouble, TreeReaderTest, testing::Bool());

TEST_P(TreeReaderTest, GivesBackEveryPointBitForBit)
{
    const MemoryCloud back = read();
    EXPECT_EQ(back.info.schema, cloud_.info.schema);
    EXPECT_EQ(back.info.grid, cloud_.info.grid);
    EXPECT_EQ(back.info.position_type, cloud_.info.position_type);
    EXPECT_EQ(back.info.metadata, cloud_.info.metadata);
    EXPECT_TRUE(back.info.points_known);
    EXPECT_TRUE(sorted_points(back) == sorted_points(cloud_));
}

TEST_P(TreeReaderTest, ALevelIsTheNodesDownToIt)
{
    ASSERT_GT(tree_->info().levels, 2);
    std::vector<std::string> before;
    for (std::uint16_t level = 0; level < tree_->info().levels; ++level) {
        const MemoryCloud part = read({}, level);
        EXPECT_EQ(part.points.size, tree_->points_to_level(level));
        std::vector<std::string> points = sorted_points(part);
        EXPECT_TRUE(std::includes(points.begin(), points.end(), before.begin(), before.end()));
        before = std::move(points);
    }
    EXPECT_TRUE(before == sorted_points(cloud_));
}

TEST_P(TreeReaderTest, SelectsWhatASelectionOfTheSourceSelects)
{
    std::mt19937_64 random(3);
    for (int round = 0; round < 25; ++round) {
        Selection selection;
        if (round % 5 != 0) {
            selection.box.emplace();
            for (int k = 0; k < 2; ++k)
                selection.box->extend(position_of(cloud_.points, cloud_.info.grid, random() % cloud_.points.size));
        }
        if (round % 2) selection.where.push_back(parse_condition("intensity>=" + std::to_string(random() % 65536)));
        if (round % 3 == 1) selection.where.push_back(parse_condition("rgb[0]=0..99,200.."));
        if (round % 4 == 1)
            selection.where.push_back(
                parse_condition("y>" + std::to_string(position_of(cloud_.points, cloud_.info.grid, 0)[1])));
        if (round % 3 == 2) {
            const Vec3d p = position_of(cloud_.points, cloud_.info.grid, random() % cloud_.points.size);
            selection.region = round % 2 ? Region::sphere(p, 40) : Region::cone(p, {1, 2, -1}, 25);
        }
        if (round % 4 == 2) selection.keep = {"gps_time"};
        if (round % 4 == 3) selection.drop = {"intensity"};
        const MemoryCloud part = read(selection, {}, 1 + random() % 2000);
        const MemoryCloud expected = select(selection);
        EXPECT_EQ(part.info.schema, expected.info.schema);
        EXPECT_TRUE(sorted_points(part) == sorted_points(expected)) << "round " << round;
    }
    Selection nowhere;
    nowhere.box = Box3d{{0, 0, 0}, {1, 1, 1}};
    EXPECT_EQ(read(nowhere).points.size, 0u);
    nowhere.box = Box3d();
    EXPECT_EQ(read(nowhere).points.size, 0u);
}

TEST_P(TreeReaderTest, SeeksToEveryPoint)
{
    TreeReader reader(tree_, {}, {}, 3);
    const MemoryCloud all = read_all(reader);
    std::mt19937_64 random(5);
    PointBatch batch;
    for (int i = 0; i < 60; ++i) {
        const std::uint64_t at = i == 0 ? 0 : i == 1 ? all.points.size : random() % all.points.size;
        reader.seek(at);
        const bool any = reader.read(batch, 10);
        ASSERT_EQ(any, at < all.points.size);
        for (std::size_t k = 0; k < batch.size; ++k) {
            ASSERT_EQ(position_of(batch, all.info.grid, k), position_of(all.points, all.info.grid, at + k));
            ASSERT_EQ(bytes_of(batch.attributes[0], k), bytes_of(all.points.attributes[0], at + k));
        }
    }
    EXPECT_THROW(reader.seek(all.points.size + 1), Error);
}

TEST_P(TreeReaderTest, ATreeOfATreeHasTheSamePoints)
{
    TreeReader reader(tree_, {}, {});
    BuildOptions options = small_chunks();
    options.chunk_points = 3000;
    build_tree(reader, {"t.pct"}, folder_ / "again.pct", options);
    const auto again = Tree::open(folder_ / "again.pct");
    EXPECT_EQ(again->info().grid, tree_->info().grid);
    EXPECT_EQ(again->info().content_hash, tree_->info().content_hash);
    EXPECT_EQ(again->info().metadata, tree_->info().metadata);
    EXPECT_EQ(again->info().wide, tree_->info().wide);
    EXPECT_TRUE(verify_tree(again->folder()).faults.empty());
}

// Damage of a chunk is an error only if the chunk is needed.
TEST_P(TreeReaderTest, ReadsOnlyWhatTheBoxTouches)
{
    const NodeId last = static_cast<NodeId>(tree_->nodes().size() - 1);
    const Node& node = tree_->node(last);
    {
        std::fstream file(folder_ / "t.pct" / ("chunks-00" + std::to_string(node.extent.file) + ".bpc"),
                          std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(node.extent.offset));
        file.write("damaged", 7);
    }
    EXPECT_THROW(read(), Error);
    const Box3d hole = tree_->box(last), bounds = tree_->info().bounds();
    for (std::size_t a = 0; a < 3; ++a) {
        Selection beside;
        beside.box = bounds;
        if (hole.max[a] < bounds.max[a])
            beside.box->min[a] = std::nextafter(hole.max[a], bounds.max[a]);
        else if (hole.min[a] > bounds.min[a])
            beside.box->max[a] = std::nextafter(hole.min[a], bounds.min[a]);
        else
            continue;
        EXPECT_TRUE(sorted_points(read(beside)) == sorted_points(select(beside)));
    }
}

// Around zero floats are finer than the tree's grid, but not finer than rounding to a float can mend.
TEST(TreeReader, FloatsComeBackAsTheyWere)
{
    const TemporaryFolder folder;
    std::mt19937_64 random(6);
    std::vector<std::array<float, 3>> points(5000);
    for (auto& p : points)
        for (float& c : p)
            c = static_cast<float>((static_cast<double>(random() >> 11) * 0x1p-52 - 1) *
                                   std::pow(10.0, static_cast<double>(random() % 8) - 5));
    write_ply(folder / "in.ply", points);
    build_tree({folder / "in.ply"}, folder / "out.pct", small_chunks());
    TreeReader reader(Tree::open(folder / "out.pct"), {}, {});
    EXPECT_EQ(reader.info().position_type, ScalarType::f32);
    EXPECT_FALSE(reader.info().grid);
    const MemoryCloud back = read_all(reader);
    std::vector<Vec3d> in, out;
    for (const auto& p : points) in.push_back({p[0], p[1], p[2]});
    for (std::size_t i = 0; i < back.points.size; ++i) out.push_back(position_of(back.points, {}, i));
    std::sort(in.begin(), in.end());
    std::sort(out.begin(), out.end());
    EXPECT_TRUE(in == out);
}

// Tiles of two offsets, far apart: their common grid needs more than 32 bits.
TEST(TreeReader, AWideGridIsReadAsDoublesThatAreNearIt)
{
    const TemporaryFolder folder;
    Grid one{{0.001, 0.001, 0.001}, {0, 0, 0}}, two = one;
    two.offset[0] = 4e6;
    write_las(folder / "a.las", records(Shape::surface, 3000, 1), one);
    write_las(folder / "b.las", records(Shape::surface, 3000, 2), two);
    build_tree({folder / "a.las", folder / "b.las"}, folder / "out.pct", small_chunks());
    const auto tree = Tree::open(folder / "out.pct");
    ASSERT_TRUE(tree->info().wide);
    TreeReader reader(tree, {}, {});
    EXPECT_FALSE(reader.info().grid);
    EXPECT_EQ(reader.info().near_grid, one);
    EXPECT_EQ(reader.info().position_type, ScalarType::f64);
    EXPECT_EQ(read_all(reader).points.size, 6000u);
    // A part of it that fits is built on the same grid, and narrow.
    Selection left;
    left.box = Box3d{{-1e6, -1e6, -1e6}, {1e6, 1e6, 1e6}};
    TreeReader part(tree, {}, left);
    build_tree(part, {"out.pct"}, folder / "left.pct", small_chunks());
    EXPECT_EQ(Tree::open(folder / "left.pct")->info().points, 3000u);
    EXPECT_EQ(Tree::open(folder / "left.pct")->info().grid, one);
    EXPECT_FALSE(Tree::open(folder / "left.pct")->info().wide);
}

TEST(TreeReader, AnEmptyTreeIsAnEmptyCloud)
{
    const TemporaryFolder folder;
    write_ply<float>(folder / "in.ply", {{std::nanf(""), 0, 0}});
    build_tree({folder / "in.ply"}, folder / "out.pct", small_chunks());
    TreeReader reader(Tree::open(folder / "out.pct"), {}, {});
    EXPECT_EQ(reader.info().points, 0u);
    EXPECT_EQ(reader.fraction_read(), 1);
    EXPECT_EQ(read_all(reader).points.size, 0u);
    reader.seek(0);
    EXPECT_FALSE(reader.info().promised_box);
    EXPECT_FALSE(reader.info().notes.empty());
}

}  // namespace
