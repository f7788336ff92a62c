#include "pcm/make_cloud.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/memory_reader.h"
#include "tests/support.h"

#include <algorithm>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

class PointCursorTest : public testing::Test {
protected:
    void SetUp() override
    {
        grid_.scale = {0.01, 0.01, 0.01};
        grid_.offset = {5e6, 4.8e6, 0};
        points_ = records(Shape::surface, 30000, 3);
        write_las(folder_ / "in.las", points_, grid_);
        BuildOptions options;
        options.chunk_points = 1000;
        build_tree({folder_ / "in.las"}, folder_ / "out.pct", options);
        L2Options cache;
        cache.capacity_bytes = 200000;  // far less than the cloud
        cloud_ = PointCloud::open(folder_ / "out.pct", cache);
    }
    TemporaryFolder folder_;
    Grid grid_;
    std::vector<LasRecord> points_;
    std::shared_ptr<PointCloud> cloud_;
};

TEST_F(PointCursorTest, AllPointsWithTheirAttributes)
{
    std::vector<std::array<std::int64_t, 5>> in, out;
    for (const LasRecord& p : points_) in.push_back({p.x, p.y, p.z, p.intensity, p.green});
    Query query;
    query.attributes = {"rgb", "intensity"};
    auto cursor = cloud_->points(query);
    PointView view;
    while (cursor.getNextData(view))
        for (std::size_t i = 0; i < view.size(); ++i) {
            const Vec3i q = view.grid_position(i);
            EXPECT_EQ(view.position(i), grid_.to_source(q));
            out.push_back({q[0], q[1], q[2], static_cast<std::int64_t>(view.value(i, 1)),
                           static_cast<std::int64_t>(view.value(i, 0, 1))});
        }
    std::sort(in.begin(), in.end());
    std::sort(out.begin(), out.end());
    EXPECT_TRUE(in == out);
    EXPECT_FALSE(cursor.getNextData(view));
    EXPECT_EQ(view.size(), 0u);
}

TEST_F(PointCursorTest, BoxesAgainstBruteForce)
{
    std::mt19937_64 random(9);
    const Box3d bounds = cloud_->info().bounds();
    for (int round = 0; round < 100; ++round) {
        Query query;
        query.box.emplace();
        for (int corner = 0; corner < 2; ++corner) {
            Vec3d p;
            for (std::size_t a = 0; a < 3; ++a)
                p[a] = bounds.min[a] + bounds.extent(a) * (static_cast<double>(random() % 1000) / 900.0 - 0.05);
            query.box->extend(p);
        }
        std::size_t expected = 0, found = 0;
        for (const LasRecord& p : points_) expected += query.box->contains(grid_.to_source(Vec3i{p.x, p.y, p.z}));
        auto cursor = cloud_->points(query);
        PointView view;
        while (cursor.getNextData(view)) {
            EXPECT_GT(view.size(), 0u);
            for (std::size_t i = 0; i < view.size(); ++i) EXPECT_TRUE(query.box->contains(view.position(i)));
            found += view.size();
        }
        EXPECT_EQ(found, expected);
    }
}

TEST_F(PointCursorTest, ConditionsOnAttributesThatTheQueryDoesNotRead)
{
    Query query;
    query.attributes = {"intensity"};
    query.where = {parse_condition("rgb[1]=10000..50000"), parse_condition("z<6500000")};
    query.box = Box3d{{5e6, 4.8e6, 0}, {5e6 + 500, 4.8e6 + 300, 1e4}};
    std::vector<std::array<std::int64_t, 4>> expected, found;
    for (const LasRecord& p : points_)
        if (p.green >= 10000 && p.green <= 50000 && query.box->contains(grid_.to_source(Vec3i{p.x, p.y, p.z})))
            expected.push_back({p.x, p.y, p.z, p.intensity});
    auto cursor = cloud_->points(query);
    PointView view;
    while (cursor.getNextData(view))
        for (std::size_t i = 0; i < view.size(); ++i) {
            const Vec3i q = view.grid_position(i);
            found.push_back({q[0], q[1], q[2], static_cast<std::int64_t>(view.value(i, 0))});
        }
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    EXPECT_GT(expected.size(), 100u);
    EXPECT_TRUE(found == expected);
    query.where = {parse_condition("nothing=1")};
    EXPECT_THROW(cloud_->points(query), Error);
}

TEST_F(PointCursorTest, LevelsAreSubsets)
{
    for (std::uint16_t level = 0; level < cloud_->info().levels; ++level) {
        Query query;
        query.level = level;
        std::uint64_t points = 0;
        auto cursor = cloud_->points(query);
        PointView view;
        while (cursor.getNextData(view)) points += view.size();
        EXPECT_EQ(points, cloud_->tree()->points_to_level(level));
    }
    const std::uint16_t level = cloud_->tree()->level_with_at_most(5000);
    EXPECT_LE(cloud_->tree()->points_to_level(level), 5000u);
    EXPECT_GT(cloud_->tree()->points_to_level(static_cast<std::uint16_t>(level + 1)), 5000u);
}

TEST_F(PointCursorTest, UnknownAttributesAreNamed)
{
    Query query;
    query.attributes = {"temperature"};
    try {
        cloud_->points(query);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("temperature"), std::string::npos);
    }
}

TEST_F(PointCursorTest, ACursorKeepsItsCloudAlive)
{
    auto cursor = cloud_->points();
    cloud_.reset();
    PointView view;
    std::size_t points = 0;
    while (cursor.getNextData(view)) points += view.size();
    EXPECT_EQ(points, points_.size());
}

// Conditions compare raw * scale + offset; views read and write raw values.
TEST(RawValues, AViewOfAScaledAttributeIsRaw)
{
    TemporaryFolder folder;
    Schema schema;
    schema.add({"temperature", ScalarType::u16, 1, 0.5, -40, ""});
    MemoryCloud cloud = random_cloud(schema, std::nullopt, 3000, 7);
    MemoryReader reader(cloud);
    create_cloud(folder / "t.pct", reader);
    Query query;
    query.attributes = {"temperature"};
    query.where = {parse_condition("temperature<=60")};  // raw: at most 200
    {
        const auto writing = PointCloud::open(folder / "t.pct", {}, Access::write);
        Query all = query;
        all.where.clear();
        auto cursor = writing->edit(all);
        for (EditView view; cursor.getNextData(view); view.mark_written())
            for (std::size_t i = 0; i < view.size(); ++i) {
                view.set(i, 0, double(i % 401));
                ASSERT_EQ(view.value(i, 0), double(i % 401));
            }
        writing->close();
    }
    const auto reading = PointCloud::open(folder / "t.pct");
    double largest = 0;
    auto cursor = reading->points(query);
    for (PointView view; cursor.getNextData(view);)
        for (std::size_t i = 0; i < view.size(); ++i) {
            largest = std::max(largest, view.value(i, 0));
            ASSERT_EQ(view.value(i, 0), view.column(0).as<std::uint16_t>()[view.index(i)]);
        }
    EXPECT_EQ(largest, 200);
}

// Positions of decimals are the source's own, and the box is compared with them.
TEST(PointCursor, DecimalsAreThoseOfTheSource)
{
    const TemporaryFolder folder;
    MemoryCloud cloud;
    cloud.info.points = 3;
    cloud.points.reset({}, false, 3);
    cloud.points.xyz = {{{-0.007, 0.1, 1000}, {1, 0.7, 1000}, {2, 3, 1000}}};
    MemoryReader reader(cloud);
    build_tree(reader, {}, folder / "tree.pct");
    const auto tree = PointCloud::open(folder / "tree.pct");
    Query query;
    query.box = Box3d{{-0.007, 0, 0}, {0.05, 1, 2}};
    auto cursor = tree->points(query);
    PointView view;
    ASSERT_TRUE(cursor.getNextData(view));
    ASSERT_EQ(view.size(), 1u);
    EXPECT_EQ(view.position(0), (Vec3d{-0.007, 1, 2}));
    EXPECT_NE(tree->info().grid.to_source(view.grid_position(0)), view.position(0));

    // Neighbours and hits too.
    const Vec3d at = {-0.007, 1, 2};
    const NearestResult nearest = tree->nearest(at, 3, {});
    ASSERT_EQ(nearest.points.size(), 3u);
    EXPECT_EQ(nearest.points[0].position, at);
    EXPECT_EQ(nearest.points[0].distance(), 0);
    EXPECT_EQ(nearest.points[1].position, (Vec3d{0.1, 0.7, 3}));
    EXPECT_EQ(nearest.points[1].squared_distance, squared_distance(nearest.points[1].position, at));
    const Region ray = Region::ray({-0.007, 0, 2}, {0, 1, 0}, 0.01);
    const HitResult hit = tree->first_hit(ray, {});
    ASSERT_TRUE(hit.hit);
    EXPECT_EQ(hit.hit->position, at);
    EXPECT_EQ(hit.hit->along, ray.along(at));
}

}  // namespace
