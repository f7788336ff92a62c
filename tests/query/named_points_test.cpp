// Points by node and number, compared with what a query over all points gives for them.
#include "pcm/make_cloud.h"

#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/support.h"

#include <algorithm>
#include <map>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

class NamedPointsTest : public testing::Test {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::surface, 20000, 5), {{0.01, 0.01, 0.01}, {5e6, 4.8e6, 0}});
        BuildOptions options;
        options.chunk_points = 1000;
        build_tree({folder_ / "in.las"}, folder_ / "out.pct", options);
    }
    std::shared_ptr<PointCloud> open(Access access = Access::read) const
    {
        L2Options cache;
        cache.capacity_bytes = 200000;  // far less than the cloud
        return PointCloud::open(folder_ / "out.pct", cache, access);
    }

    struct Expected {
        PointName name;
        Vec3d position;
        std::array<double, 4> values;  // red, green, blue, intensity
    };
    static std::vector<Expected> all_of(PointCloud& cloud)
    {
        std::vector<Expected> all;
        Query query;
        query.attributes = {"rgb", "intensity"};
        auto cursor = cloud.points(query);
        for (PointView view; cursor.getNextData(view);)
            for (std::size_t i = 0; i < view.size(); ++i)
                all.push_back({{view.node(), view.number(i)},
                               view.position(i),
                               {view.value(i, 0, 0), view.value(i, 0, 1), view.value(i, 0, 2), view.value(i, 1)}});
        return all;
    }
    static std::vector<PointName> names_of(const std::vector<Expected>& points)
    {
        std::vector<PointName> names;
        for (const Expected& point : points) names.push_back(point.name);
        return names;
    }

    TemporaryFolder folder_;
};

TEST_F(NamedPointsTest, AreInTheOrderOfTheirNamesWhateverThatIs)
{
    const auto cloud = open();
    std::vector<Expected> points = all_of(*cloud);
    ASSERT_EQ(points.size(), 20000u);
    std::mt19937 random(7);
    std::shuffle(points.begin(), points.end(), random);
    points.resize(5000);
    points.insert(points.end(), {points[0], points[0], points[17]});
    const NamedPoints found = cloud->values(names_of(points), {"intensity", "rgb"});
    ASSERT_EQ(found.positions.size(), points.size());
    ASSERT_EQ(found.columns.size(), 2u);
    ASSERT_EQ(found.columns[0].size(), points.size());
    EXPECT_EQ(found.columns[0].type(), ScalarType::u16);
    EXPECT_EQ(found.columns[1].components(), 3u);
    for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(found.positions[i], points[i].position) << i;
        for (std::uint32_t k = 0; k < 3; ++k) ASSERT_EQ(found.columns[1].value(i, k), points[i].values[k]) << i;
        ASSERT_EQ(found.columns[0].value(i), points[i].values[3]) << i;
    }
}

TEST_F(NamedPointsTest, EachChunkIsReadOnce)
{
    const auto cloud = open();
    std::vector<Expected> points = all_of(*cloud);
    std::mt19937 random(8);
    std::shuffle(points.begin(), points.end(), random);
    std::map<NodeId, std::size_t> nodes;
    for (const Expected& point : points) ++nodes[point.name.node];
    const auto fresh = open();
    fresh->values(names_of(points), {"intensity"});
    EXPECT_EQ(fresh->cache().statistics().compulsory_misses + fresh->cache().statistics().capacity_misses,
              nodes.size());
}

TEST_F(NamedPointsTest, HaveWhatWasSetBeforeItIsOnDisk)
{
    const auto cloud = open(Access::write);
    Query query;
    query.attributes = {"intensity"};
    std::vector<PointName> names;
    {
        auto cursor = cloud->edit(query);
        EditView view;
        ASSERT_TRUE(cursor.getNextData(view));
        for (std::size_t i = 0; i < view.size(); ++i) {
            view.set(i, 0, static_cast<double>(i));
            names.push_back({view.node(), view.index(i)});
        }
        view.mark_written();
    }
    const NamedPoints found = cloud->values(names, {"intensity"});
    for (std::size_t i = 0; i < names.size(); ++i) ASSERT_EQ(found.columns[0].value(i), static_cast<double>(i));
    cloud->abandon();
}

TEST_F(NamedPointsTest, NamesThatTheCloudDoesNotHaveAreRefused)
{
    const auto cloud = open();
    const auto refused = [&](const std::vector<PointName>& names, const std::vector<std::string>& attributes) {
        try {
            cloud->values(names, attributes);
            return std::string("accepted");
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            return std::string(error.what());
        }
    };
    NodeId node = 0;
    while (cloud->tree()->node(node).points == 0) ++node;
    const std::uint32_t points = cloud->tree()->node(node).points;
    EXPECT_EQ(refused({{node, points - 1}}, {}), "accepted");
    EXPECT_NE(refused({{node, 0}, {node, points}}, {})
                  .find("no point " + std::to_string(points) + " of node " + std::to_string(node)),
              std::string::npos);
    EXPECT_NE(refused({{1000000, 3}}, {}).find("no point 3 of node 1000000"), std::string::npos);
    EXPECT_NE(refused({{no_node, 0}}, {}).find("no point"), std::string::npos);
    EXPECT_NE(refused({}, {"nix"}).find("'nix'"), std::string::npos);
    const NamedPoints none = cloud->values({}, {"rgb"});
    EXPECT_TRUE(none.positions.empty());
    EXPECT_EQ(none.columns.at(0).size(), 0u);
}

}  // namespace
