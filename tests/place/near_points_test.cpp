// Neighbourhoods of places against a search through all points.

#include "pcm/place/near_points.h"

#include "pcm/cloud/condition.h"
#include "pcm/system/error.h"
#include "pcm/update/erase.h"
#include "tests/sanitizers.h"
#include "tests/select/cloud_of_points.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <tuple>

namespace {

using namespace pcm;
using namespace pcm::test;

class NearPointsTest : public CloudOfPoints {
protected:
    std::shared_ptr<PointCloud> open() const { return PointCloud::open(path()); }

    // All points that are allowed, the nearest first.
    std::vector<const KnownPoint*> ordered(const Vec3d& place,
                                           const std::function<bool(const KnownPoint&)>& allowed) const
    {
        std::vector<const KnownPoint*> all;
        for (const KnownPoint& p : points_)
            if (allowed(p)) all.push_back(&p);
        const auto key = [&](const KnownPoint* p) {
            return std::make_tuple(squared_distance(p->position, place), p->node, p->number);
        };
        std::sort(all.begin(), all.end(), [&](auto* a, auto* b) { return key(a) < key(b); });
        return all;
    }

    void check(
        const Vec3d& place, const NearOptions& options,
        const std::function<bool(const KnownPoint&)>& allowed = [](const KnownPoint&) { return true; })
    {
        std::vector<const KnownPoint*> wanted = ordered(place, allowed);
        const auto is_far = [&](const KnownPoint* p) {
            return squared_distance(p->position, place) > options.radius * options.radius;
        };
        if (options.count > 0)
            wanted.resize(std::min(wanted.size(), options.count));
        else
            wanted.erase(std::find_if(wanted.begin(), wanted.end(), is_far), wanted.end());
        const NearPoints found = points_near(*open(), place, options);
        ASSERT_EQ(found.points.size(), wanted.size());
        ASSERT_EQ(found.ids.size(), wanted.size());
        EXPECT_EQ(found.found, wanted.size());
        EXPECT_FALSE(found.points.has_normals());
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            ASSERT_EQ(found.ids[i].node, wanted[i]->node) << i;
            ASSERT_EQ(found.ids[i].index, wanted[i]->number) << i;
            ASSERT_EQ(found.points.at(i), wanted[i]->position - found.points.origin) << i;
        }
        if (!wanted.empty()) EXPECT_EQ(found.points.origin, wanted[0]->position);
        if (options.count == 0)
            EXPECT_EQ(found.radius, options.radius);
        else if (!wanted.empty())
            EXPECT_EQ(found.radius, std::sqrt(squared_distance(wanted.back()->position, place)));
        largest_ = std::max(largest_, wanted.size());
    }
    std::size_t largest_ = 0;
};

NearOptions of_count(std::size_t count)
{
    NearOptions options;
    options.count = count;
    return options;
}

NearOptions of_radius(double radius)
{
    NearOptions options;
    options.radius = radius;
    return options;
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(NearPointsTest, PCM_NOT_UNDER_THREAD(AreThoseOfASearchThroughAll))
{
    for (const Shape shape : {Shape::surface, Shape::volume, Shape::line, Shape::duplicates, Shape::clusters}) {
        std::filesystem::remove_all(path());
        make(shape, 8000);
        std::mt19937_64 random(5);
        for (int round = 0; round < 6; ++round) {
            // At a point, between points, and outside of the cloud.
            Vec3d place = points_[random() % points_.size()].position;
            if (round % 3 == 1) place = place + 0.01 * size() * Vec3d{1, -1, 0.5};
            if (round % 3 == 2) place = place + 3 * size() * Vec3d{1, 0.1, -0.2};
            for (const std::size_t count : {std::size_t(1), std::size_t(7), std::size_t(500), std::size_t(20000)})
                check(place, of_count(count));
            for (const double part : {0.001, 0.03, 0.4}) check(place, of_radius(part * size()));
        }
    }
    EXPECT_EQ(largest_, points_.size());
}

// Only the first of the points at one place counts, however many there are.
TEST_F(NearPointsTest, PlacesAreCountedOnce)
{
    for (const Shape shape : {Shape::duplicates, Shape::surface}) {
        std::filesystem::remove_all(path());
        make(shape, 8000);
        for (const std::size_t count : {std::size_t(1), std::size_t(9), std::size_t(100)}) {
            const Vec3d place = points_[3 * count].position;
            std::vector<const KnownPoint*> wanted;
            std::map<Vec3d, const KnownPoint*> known;
            for (const KnownPoint* p : ordered(place, [](const KnownPoint&) { return true; }))
                if (known.emplace(p->position, p).second && wanted.size() < count) wanted.push_back(p);
            NearOptions options = of_count(count);
            options.places = true;
            const NearPoints found = points_near(*open(), place, options);
            ASSERT_EQ(found.ids.size(), wanted.size()) << count;
            for (std::size_t i = 0; i < wanted.size(); ++i) {
                EXPECT_EQ(found.ids[i].node, wanted[i]->node) << i;
                EXPECT_EQ(found.ids[i].index, wanted[i]->number) << i;
            }
            EXPECT_EQ(found.found, found.ids.size());
        }
    }
}

// A point exactly at the radius belongs to it.
TEST_F(NearPointsTest, TheRadiusIsInclusive)
{
    make(Shape::surface, 3000);
    const Vec3d place = points_[17].position;
    const auto all = ordered(place, [](const KnownPoint&) { return true; });
    const double square = squared_distance(all[40]->position, place);
    double radius = std::sqrt(square);
    while (radius * radius < square) radius = std::nextafter(radius, HUGE_VAL);
    EXPECT_GE(points_near(*open(), place, of_radius(radius)).found, 41u);
    check(place, of_radius(radius));
}

TEST_F(NearPointsTest, OnlyWhatTheLimitChooses)
{
    make(Shape::surface, 8000);
    NearOptions options = of_count(300);
    options.limit.where.push_back(parse_condition("classification<128"));
    options.limit.box = Box3d{middle() - Vec3d{30, 90, 900}, middle() + Vec3d{5, 90, 900}};
    options.limit.clips.push_back({Region::sphere(middle(), 4), true});
    const auto allowed = [&](const KnownPoint& p) {
        return p.classification < 128 && options.limit.box->contains(p.position) &&
               options.limit.clips[0].holds(p.position);
    };
    check(middle(), options, allowed);
    options.count = 0;
    options.radius = 12;
    check(middle(), options, allowed);
    EXPECT_GT(largest_, 100u);
    options.limit.where.push_back(parse_condition("nothing=1"));
    EXPECT_THROW(points_near(*open(), middle(), options), Error);
}

TEST_F(NearPointsTest, DeletedPointsAreNotThere)
{
    make(Shape::surface, 6000);
    erase_points(path(), [&] {
        Selection selection;
        selection.region = Region::sphere(middle(), 10);
        return selection;
    }());
    read();
    check(middle(), of_count(200));
}

// Too many: a part, the same each time, that leaves no gap wider than the levels allow.
TEST_F(NearPointsTest, OfTooManyAnEvenPartIsGiven)
{
    make(Shape::surface, 40000, 4000);
    NearOptions options = of_radius(40);
    const NearPoints all = points_near(*open(), middle(), options);
    ASSERT_GT(all.found, 8000u);
    for (const std::size_t most : {std::size_t(2000), std::size_t(500)}) {
        options.most = most;
        const NearPoints part = points_near(*open(), middle(), options);
        EXPECT_EQ(part.found, all.found);
        EXPECT_EQ(part.spacing, all.spacing);
        ASSERT_EQ(part.points.size(), most);
        // The maximum distance of a point from the part: about the spacing of `most` points on the surface.
        double widest = 0;
        for (std::size_t i = 0; i < all.points.size(); i += 7) {
            double least = HUGE_VAL;
            for (std::size_t k = 0; k < part.points.size(); ++k)
                least = std::min(least, squared_distance(all.points.source(i), part.points.source(k)));
            widest = std::max(widest, std::sqrt(least));
        }
        EXPECT_LT(widest, 3.5 * std::sqrt(pi * 40 * 40 / static_cast<double>(most))) << most;
        const NearPoints again = points_near(*open(), middle(), options);
        ASSERT_EQ(again.points.size(), most);
        for (std::size_t i = 0; i < most; ++i) EXPECT_EQ(again.points.source(i), part.points.source(i));
        std::set<std::pair<NodeId, std::uint32_t>> ids;
        for (const NearPoints::Id& id : part.ids) ids.emplace(id.node, id.index);
        EXPECT_EQ(ids.size(), most);
    }
    options = of_count(3000);
    options.most = 700;
    const NearPoints part = points_near(*open(), middle(), options);
    EXPECT_EQ(part.found, 3000u);
    EXPECT_EQ(part.points.size(), 700u);
    EXPECT_EQ(part.radius, points_near(*open(), middle(), of_count(3000)).radius);
}

TEST_F(NearPointsTest, TheSpacingIsThatOfThePoints)
{
    make(Shape::surface, 20000);
    const NearPoints found = points_near(*open(), middle(), of_count(200));
    std::vector<double> distances;
    for (std::size_t i = 0; i < 200; ++i) {
        double least = HUGE_VAL;
        for (const KnownPoint& p : points_) {
            const double square = squared_distance(p.position, found.points.source(i));
            if (square > 0) least = std::min(least, square);
        }
        distances.push_back(std::sqrt(least));
    }
    std::sort(distances.begin(), distances.end());
    EXPECT_NEAR(found.spacing, distances[100], 0.15 * distances[100]);

    std::filesystem::remove_all(path());
    make(Shape::coincident, 500);
    EXPECT_EQ(points_near(*open(), middle(), of_count(200)).spacing, 0);
}

// A click reads the positions of what is near, and no other column.
TEST_F(NearPointsTest, ReadsThePositionsOfTheNodesNearby)
{
    make(Shape::surface, 8000);
    const auto cloud = open();
    ASSERT_GT(cloud->tree()->nodes().size(), 10u);
    points_near(*cloud, points_[17].position, of_count(30));
    const TreeReads reads = cloud->tree()->reads();
    EXPECT_EQ(reads.columns, ColumnSet::only_positions());
    EXPECT_LT(reads.chunks, cloud->tree()->nodes().size() / 2);
    const auto again = Tree::open(path());
    for (NodeId node = 0; node < again->nodes().size(); ++node) again->read_chunk(node, ColumnSet::only_positions());
    EXPECT_LT(reads.bytes, again->reads().bytes / 2);
}

// Unit normals of the cloud, also where it keeps them longer or has none.
TEST_F(NearPointsTest, HaveTheCloudsNormals)
{
    std::ofstream ply(folder_ / "n.ply");
    ply << "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
           "property float nx\nproperty float ny\nproperty float nz\nend_header\n"
           "0 0 0 0 0 2\n1 0 0 0 0 0\n2 0 0 nan 0 1\n";
    ply.close();
    build_tree({folder_ / "n.ply"}, path(), {});
    const NearPoints found = points_near(*open(), {0, 0, 0}, of_count(5));
    ASSERT_EQ(found.points.size(), 3u);
    ASSERT_TRUE(found.points.has_normals());
    EXPECT_EQ(found.points.normal(0), (Vec3d{0, 0, 1}));
    EXPECT_EQ(found.points.normal(1), (Vec3d{0, 0, 0}));
    EXPECT_EQ(found.points.normal(2), (Vec3d{0, 0, 0}));
}

TEST_F(NearPointsTest, OptionsOutOfRangeAreRefused)
{
    make(Shape::surface, 1000);
    const auto refused = [&](const Vec3d& place, const NearOptions& options) {
        try {
            points_near(*open(), place, options);
        } catch (const Error& error) {
            return error.code() == ErrorCode::invalid_argument;
        }
        return false;
    };
    EXPECT_TRUE(refused(middle(), {}));
    NearOptions both = of_count(3);
    both.radius = 1;
    EXPECT_TRUE(refused(middle(), both));
    for (const double radius : {-1.0, std::nan(""), HUGE_VAL}) EXPECT_TRUE(refused(middle(), of_radius(radius)));
    EXPECT_TRUE(refused(middle(), of_count(20000000)));
    EXPECT_TRUE(refused({std::nan(""), 0, 0}, of_count(3)));
    NearOptions none = of_count(3);
    none.most = 0;
    EXPECT_TRUE(refused(middle(), none));
    EXPECT_FALSE(refused(middle(), of_count(3)));
    EXPECT_EQ(points_near(*open(), {0, 0, 0}, of_radius(1)).found, 0u);
}

TEST_F(NearPointsTest, CanBeCancelled)
{
    make(Shape::surface, 4000);
    NearOptions options = of_count(10);
    options.progress = [](const ProgressUpdate&) { return false; };
    try {
        points_near(*open(), middle(), options);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
}

}  // namespace
