// Queries at their limits: cancelled, dropped, refused, reading little, on damaged trees.

#include "pcm/build/builder.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/support.h"

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>

namespace {

using namespace pcm;
using namespace pcm::test;

class QueryLimits : public testing::Test {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::volume, 40000, 3), {{0.01, 0.01, 0.01}, {5e6, 4.8e6, 0}});
        BuildOptions options;
        options.chunk_points = 1000;
        build_tree({folder_ / "in.las"}, folder_ / "t.pct", options);
        cloud_ = PointCloud::open(folder_ / "t.pct");
    }
    TemporaryFolder folder_;
    std::shared_ptr<PointCloud> cloud_;
};

TEST_F(QueryLimits, ACursorMayBeCancelledAndDestroyedAtAnyTime)
{
    Query query;
    query.region = Region::sphere({5e6, 4.8e6, 0}, 450);
    query.reads_in_flight = 8;
    int calls = 0;
    double last = -1;
    query.progress = [&](const ProgressUpdate& update) {
        EXPECT_GE(update.fraction, last);
        EXPECT_LE(update.fraction, 1.0);
        last = update.fraction;
        return ++calls < 4;
    };
    auto cursor = cloud_->points(query);
    PointView view;
    try {
        while (cursor.getNextData(view)) {
        }
        ADD_FAILURE() << "not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
    EXPECT_EQ(calls, 4);
    query.progress = {};
    for (int chunks = 0; chunks < 30; ++chunks) {
        auto dropped = cloud_->points(query);
        for (int i = 0; i < chunks && dropped.getNextData(view); ++i) {
        }
    }
    // Only the cursor still holds the cloud.
    auto last_one = cloud_->points(query);
    EXPECT_TRUE(last_one.getNextData(view));
    cloud_.reset();
    EXPECT_TRUE(last_one.getNextData(view));
}

TEST_F(QueryLimits, ReadsOnlyWhatIsNear)
{
    Query query;
    query.region = Region::sphere({5e6 + 100, 4.8e6 - 50, 30}, 20);
    const Estimate before = cloud_->estimate(query);
    EXPECT_FALSE(before.seconds);
    auto cursor = cloud_->points(query);
    PointView view;
    while (cursor.getNextData(view)) {
    }
    EXPECT_LT(cursor.statistics().points_read, 10000u);
    EXPECT_LE(cursor.statistics().points_read, before.points_read);
    EXPECT_GT(cursor.statistics().bytes_read, 0u);
    EXPECT_LE(cursor.statistics().bytes_read, before.bytes);
    // Chunks that the query cuts are not kept in the cache.
    EXPECT_EQ(cloud_->cache().statistics().resident_chunks, 0u);
    const Estimate after = cloud_->estimate(query);
    ASSERT_TRUE(after.seconds);
    EXPECT_GT(*after.seconds, 0);
    // Chunks that the cache holds are used from there.
    auto everything = cloud_->points();
    while (everything.getNextData(view)) {
    }
    auto again = cloud_->points(query);
    while (again.getNextData(view)) {
    }
    EXPECT_EQ(again.statistics().chunks_cached, again.statistics().chunks);
    EXPECT_EQ(again.statistics().bytes_read, 0u);
    EXPECT_EQ(cloud_->estimate(query).bytes, 0u);
}

TEST_F(QueryLimits, InvalidQueriesAreRefused)
{
    EXPECT_THROW(cloud_->nearest({NAN, 0, 0}, 1), Error);
    EXPECT_THROW(cloud_->nearest(std::vector<Vec3d>{{0, 0, 0}, {0, INFINITY, 0}}, 1), Error);
    NearestOptions options;
    options.max_distance = -1;
    EXPECT_THROW(cloud_->nearest({0, 0, 0}, 1, options), Error);
    EXPECT_THROW(cloud_->first_hit(Region::sphere({0, 0, 0}, 1)), Error);
    Query query;
    query.attributes = {"temperature"};
    EXPECT_THROW(cloud_->estimate(query), Error);
    EXPECT_TRUE(cloud_->nearest(std::vector<Vec3d>{}, 3).points.empty());
    options.max_distance = INFINITY;
    options.threads = 2;
    options.progress = [](const ProgressUpdate&) { return false; };
    const std::vector<Vec3d> many(200000, Vec3d{5e6, 4.8e6, 0});
    try {
        cloud_->nearest(many, 8, options);
        ADD_FAILURE() << "not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
}

// The largest distance is inclusive, for nodes and blocks whose boxes are just as far too: 3, 4 and 5 are exact.
TEST_F(QueryLimits, ANeighbourExactlyAtTheLargestDistance)
{
    for (const std::size_t others : {0u, 5000u}) {
        std::vector<LasRecord> points = records(Shape::volume, others, 4);
        for (LasRecord& point : points) point.x = std::abs(point.x) + 400, point.y = std::abs(point.y) + 400;
        points.emplace_back();
        points.back().x = 12;
        points.back().y = 16;
        points.back().z = 0;
        write_las(folder_ / "exact.las", points, {{0.25, 0.25, 0.25}, {0, 0, 0}});
        BuildOptions options;
        options.chunk_points = 1000;
        options.overwrite = true;
        build_tree({folder_ / "exact.las"}, folder_ / "exact.pct", options);
        const auto cloud = PointCloud::open(folder_ / "exact.pct");
        NearestOptions within;
        within.max_distance = 5;
        const NearestResult found = cloud->nearest({0, 0, 0}, 3, within);
        ASSERT_EQ(found.points.size(), 1u) << others;
        EXPECT_EQ(found.points[0].squared_distance, 25);
        EXPECT_EQ(found.least_distance, 5);
        EXPECT_EQ(cloud->nearest(std::vector<Vec3d>{{0, 0, 0}, {6, 8, 0}}, 3, within).points.size(), 2u) << others;
        within.max_distance = std::nextafter(5.0, 0.0);
        EXPECT_TRUE(cloud->nearest({0, 0, 0}, 3, within).points.empty()) << others;
    }
}

TEST_F(QueryLimits, DamageReachesTheCaller)
{
    cloud_.reset();
    // Bytes of columns, behind the first chunk's header.
    std::fstream file(folder_ / "t.pct" / "chunks-000.bpc", std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(0, std::ios::end);
    const auto size = static_cast<std::size_t>(file.tellg());
    for (std::size_t at = 3000; at < size; at += 500) {
        file.seekp(static_cast<std::streamoff>(at));
        file.put('\x55');
    }
    file.close();
    cloud_ = PointCloud::open(folder_ / "t.pct");
    Query query;
    query.region = Region::sphere({5e6, 4.8e6, 0}, 300);
    PointView view;
    auto cursor = cloud_->points(query);
    EXPECT_THROW(
        {
            while (cursor.getNextData(view)) {
            }
        },
        Error);
    EXPECT_THROW(cloud_->nearest({5e6, 4.8e6, 0}, 40000), Error);
    EXPECT_THROW(cloud_->nearest(std::vector<Vec3d>(1000, Vec3d{5e6, 4.8e6, 0}), 1000), Error);
}

}  // namespace
