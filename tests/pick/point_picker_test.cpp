// Picks against a look at every point, by the formulas that point_picker.h states.
#include "pcm/pick/point_picker.h"

#include "pcm/build/builder.h"
#include "pcm/pick/pick_cone.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/tree/point_size.h"
#include "tests/clouds.h"
#include "tests/memory_reader.h"
#include "tests/sanitizers.h"
#include "tests/support.h"
#include "tests/tree/small_tree.h"
#include "tests/view/random_views.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <thread>
#include <tuple>

namespace {

using namespace pcm;
using namespace pcm::test;

struct Record {
    NodeId node;
    std::uint32_t index;
    double limit;  // maximum radius
    Vec3d position;
    double size, fitted, classification;
};

enum class Cloud {
    surface,
    volume,
    line,
    duplicates,
    coincident,
    clusters,
    full_range,
    wide,
    tiny,
    radii,
    groups,
    single
};

const char* name(Cloud cloud)
{
    static const char* names[] = {"surface",    "volume", "line", "duplicates", "coincident", "clusters",
                                  "full_range", "wide",   "tiny", "radii",      "groups",     "single"};
    return names[static_cast<int>(cloud)];
}

class PointPickerTest : public testing::TestWithParam<Cloud> {
protected:
    void SetUp() override
    {
        const std::filesystem::path out = folder_ / "t.pct";
        build(GetParam(), out);
        L2Options cache;
        cache.capacity_bytes = 100000;  // a few chunks of them
        cloud_ = PointCloud::open(out, cache);
        read_all(*cloud_->tree());
        bounds_ = cloud_->info().bounds();
        size_ = std::max(bounds_.diagonal(), 1e-3);
    }

    void build(Cloud kind, const std::filesystem::path& out)
    {
        BuildOptions options;
        options.chunk_points = 2000;
        options.threads = 2;
        options.memory_bytes = 64 << 20;
        Schema schema;
        schema.add({"classification", ScalarType::u8, 1, 1, 0, ""});
        if (kind == Cloud::groups) {
            // Groups of three points, far from the others, and a dense patch that makes fine levels: sizes of points in
            // groups are far above the spacings of their levels. Chunks of several segments.
            MemoryCloud cloud = random_cloud(schema, std::nullopt, 36000, 5, 100);
            for (std::size_t i = 0; i < 36000; ++i)
                for (std::size_t a = 0; a < 3; ++a) {
                    double& c = cloud.points.xyz[a][i];
                    if (i >= 18000)
                        c = a == 2 ? 0 : c * 0.015;
                    else if (i % 3 != 0)
                        c = cloud.points.xyz[a][i - i % 3] + std::fmod(c, 1.0) * 0.05;
                }
            MemoryReader reader(cloud);
            options.chunk_points = 20000;
            build_tree(reader, {"memory"}, out, options);
            return;
        }
        if (kind == Cloud::wide || kind == Cloud::tiny || kind == Cloud::radii) {
            if (kind == Cloud::radii) schema.add({"radius", ScalarType::f32, 1, 0.01, 0, ""});
            const double extent = kind == Cloud::wide ? 1e9 : kind == Cloud::tiny ? 1e-6 : 10;
            MemoryCloud cloud = random_cloud(schema, std::nullopt, 9000, 5, extent);
            if (kind == Cloud::wide)  // clusters of a thousandth in a box of 1e9: positions of 64 bits
                for (std::size_t i = 0; i < 6000; ++i)
                    for (std::size_t a = 0; a < 3; ++a) {
                        double& c = cloud.points.xyz[a][i];
                        c = (i % 3 ? 9e8 : -9e8) + std::fmod(c, 1.0) * 1e-3;
                    }
            MemoryReader reader(cloud);
            build_tree(reader, {"memory"}, out, options);
            return;
        }
        static const Shape shapes[] = {Shape::surface,    Shape::volume,   Shape::line,      Shape::duplicates,
                                       Shape::coincident, Shape::clusters, Shape::full_range};
        const Shape shape = kind == Cloud::single ? Shape::surface : shapes[static_cast<int>(kind)];
        Grid grid{{0.001, 0.001, 0.001}, {5e6, 4.8e6, 0}};
        if (shape == Shape::clusters || shape == Shape::full_range) grid.offset = {-3, 7, 0.5};
        write_las(folder_ / "in.las", records(shape, kind == Cloud::single ? 1 : 9000, 3), grid);
        build_tree({folder_ / "in.las"}, out, options);
    }

    void read_all(const Tree& tree)
    {
        const TreeInfo& info = tree.info();
        const std::size_t classification = *info.schema.find("classification");
        const auto radius = info.schema.find("radius");
        const Vec3d extent = info.bounds().max - info.bounds().min;
        const double most = 0.05 * std::max({extent[0], extent[1], extent[2]});
        for (NodeId id = 0; id < tree.nodes().size(); ++id) {
            const Node& node = tree.node(id);
            const Chunk chunk = tree.read_chunk(id, ColumnSet::whole(info.schema));
            std::vector<PointShape> shapes;
            find_shapes(*chunk.positions, info.grid.scale, points_of_segments(node), shapes);
            std::uint32_t i = 0;
            for (std::size_t k = 0; k < node.level_points.size(); ++k) {
                const std::size_t level = node.first_level + k;
                const double limit =
                    level == 0 ? std::numeric_limits<double>::infinity() : 4 * info.spacings[level - 1];
                for (const std::uint32_t end = i + node.level_points[k]; i < end; ++i) {
                    const std::uint8_t code = chunk.sizes->as<std::uint8_t>()[i];
                    ASSERT_EQ(code == unknown_size, most == 0) << "one place has no neighbours";
                    const double known = code == unknown_size ? 0 : point_size(code, least_point_size(info.grid));
                    auto size = static_cast<float>(std::min(most, known));
                    float fitted = size * static_cast<float>(size_factor(shapes[i]));
                    if (radius) {
                        const double own = chunk.attributes[*radius]->value(i) * 0.01;
                        if (own > 0) fitted = size = static_cast<float>(own);
                    }
                    all_.push_back({id, i, limit, info.grid.to_source(chunk.positions->grid(i)),
                                    static_cast<double>(size), static_cast<double>(fitted),
                                    chunk.attributes[classification]->value(i)});
                }
            }
        }
        ASSERT_EQ(all_.size(), info.points);
    }

    template <class Shown>
    const Record* brute_force(const PickRay& ray, const PickOptions& options, const Shown& shown, double* depth) const
    {
        const Record* best = nullptr;
        double least = 0;
        for (const Record& record : all_) {
            const Vec3d d = (record.position - ray.centre) - ray.start;
            const double t = dot(ray.direction, d);
            if (t < ray.begin || t > ray.end) continue;
            const Vec3d across = d - t * ray.direction;
            const double square = dot(across, across), pixel = ray.pixel + t * ray.pixel_growth;
            const double own =
                options.size_scale * std::min(options.fitted ? record.fitted : record.size, record.limit);
            const double reach = std::min(std::max(own, options.tolerance_px * pixel), options.largest_px * pixel);
            if (std::sqrt(square) > reach || !shown(record)) continue;
            const double key = square > 0 ? t + square / (2 * reach) : t;
            if (best && std::tie(key, record.node, record.index) >= std::tie(least, best->node, best->index)) continue;
            best = &record;
            least = key;
        }
        if (depth) *depth = least;
        return best;
    }

    // Most rays aim at a point of the cloud, some next to it.
    PickRay random_ray(std::mt19937_64& random) const
    {
        std::uniform_real_distribution<double> unit(0, 1);
        const Vec3d aim = all_[random() % all_.size()].position;
        const double away = size_ * std::pow(10.0, 3 * unit(random) - 2.5);
        if (random() % 4 == 0) {
            Vec3d direction{unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5};
            if (random() % 3 == 0) direction = {0, 0, -1};
            const Vec3d from = aim - away * normalised(direction);
            return PickRay::along(from, direction, 0, std::pow(10.0, -1 - 4 * unit(random)));
        }
        Camera camera = random_view(random, aim + Vec3d{away, 0, 0}, bounds_.centre(), size_);
        // Turned so that the aim is at a place of the picture.
        const auto seen = clip(camera, aim);
        if (is_visible(seen)) {
            const double x = (seen[0] / seen[3] + 1) / 2 * camera.width + 20 * (unit(random) - 0.5) * (random() % 2);
            const double y = (1 - seen[1] / seen[3]) / 2 * camera.height + 20 * (unit(random) - 0.5) * (random() % 2);
            if (const auto ray = PickRay::through(camera, x, y)) return *ray;
        }
        const auto ray = PickRay::through(camera, camera.width * unit(random), camera.height * unit(random));
        return ray ? *ray : PickRay::along(aim - Vec3d{0, 0, -away}, {0, 0, -1}, 0, 0.001);
    }

    TemporaryFolder folder_;
    std::shared_ptr<PointCloud> cloud_;
    std::vector<Record> all_;
    Box3d bounds_;
    double size_ = 1;
};

TEST_P(PointPickerTest, FindsWhatALookAtEveryPointFinds)
{
    PointPicker picker(cloud_->cache());
    std::mt19937_64 random(7);
    int hits = 0, between = 0;
    for (int i = 0; i < tries(1500, 300); ++i) {
        SCOPED_TRACE(i);
        const PickRay ray = random_ray(random);
        PickOptions options;
        if (i % 3 == 0) options.tolerance_px = 1 + static_cast<double>(random() % 10);
        if (i % 7 == 0) options.size_scale = 0;
        options.fitted = i % 3 != 0;
        if (i % 11 == 0) options.largest_px = options.tolerance_px;
        options.reads_in_flight = i % 2 ? 8 : 1;
        if (i % 50 == 0) cloud_->cache().clear();
        double depth = 0;
        const Record* expected = brute_force(
            ray, options, [](const Record&) { return true; }, &depth);
        const PickResult first = picker.in_memory(ray, options);
        if (first.hit) {
            ASSERT_TRUE(expected);
            EXPECT_GE(first.hit->depth, depth);
        }
        const PickResult found = picker.exact(ray, options, i % 2 ? first.hit : std::nullopt);
        ASSERT_EQ(found.hit.has_value(), expected != nullptr);
        if (!expected) continue;
        ++hits;
        between += found.hit->beside > 0;
        ASSERT_EQ(std::tie(found.hit->node, found.hit->index), std::tie(expected->node, expected->index));
        EXPECT_EQ(found.hit->depth, depth);
        EXPECT_EQ(found.hit->size, options.fitted ? expected->fitted : expected->size);
    }
    EXPECT_GT(hits, tries(300, 60));
    if (GetParam() != Cloud::coincident && GetParam() != Cloud::single) EXPECT_GT(between, tries(100, 20));
}

TEST_P(PointPickerTest, FindsWhatConditionsAndClipsLeave)
{
    PointPicker picker(cloud_->cache());
    std::mt19937_64 random(8);
    std::uniform_real_distribution<double> unit(0, 1);
    int hits = 0, changed = 0;
    for (int i = 0; i < tries(600, 120); ++i) {
        SCOPED_TRACE(i);
        const PickRay ray = random_ray(random);
        PickOptions options;
        const double most = 256 * unit(random);
        options.where = {parse_condition("classification<=" + std::to_string(most))};
        const double cut = bounds_.min[0] + unit(random) * (bounds_.max[0] - bounds_.min[0]);
        if (i % 2) options.where.push_back(parse_condition("x>=" + pcm::exact(cut)));
        const Vec3d centre = all_[random() % all_.size()].position;
        const Clip clip{Region::sphere(centre, size_ * std::pow(10.0, -2 * unit(random))), i % 3 == 0};
        if (i % 4 != 0) options.clips = {clip};
        const auto shown = [&](const Record& record) {
            return record.classification <= most && (i % 2 == 0 || record.position[0] >= cut) &&
                   (i % 4 == 0 || clip.holds(record.position));
        };
        const Record* expected = brute_force(ray, options, shown, nullptr);
        const PickResult found = picker.exact(ray, options, picker.in_memory(ray, options).hit);
        ASSERT_EQ(found.hit.has_value(), expected != nullptr);
        const Record* without = brute_force(
            ray, options, [](const Record&) { return true; }, nullptr);
        changed += without != expected;
        if (!expected) continue;
        ++hits;
        ASSERT_EQ(std::tie(found.hit->node, found.hit->index), std::tie(expected->node, expected->index));
    }
    if (GetParam() == Cloud::single) return;
    EXPECT_GT(hits, tries(20, 4));
    EXPECT_GT(changed, tries(20, 4));
}

// With the answer known from the beginning, those chunks are looked at that can hold a better one: of each level no
// splat is larger than the level's limit, however deep its chunk lies below chunks of coarser levels.
TEST_P(PointPickerTest, LooksAtNoMoreChunksThanTheSizesOfTheirLevelsAsk)
{
    PointPicker picker(cloud_->cache());
    const Tree& tree = *cloud_->tree();
    std::mt19937_64 random(12);
    for (int i = 0; i < tries(200, 40); ++i) {
        SCOPED_TRACE(i);
        const PickRay ray = random_ray(random);
        const PickOptions options;
        const auto hit = picker.exact(ray, options).hit;
        if (!hit) continue;
        const PickCone cone(ray, options, tree.info());
        std::uint64_t expected = 0;
        for (NodeId id = 0; id < tree.nodes().size(); ++id) {
            if (tree.node(id).points == 0) continue;
            const auto depth = cone.least_depth(tree.box(id), cone.limit(tree.node(id).first_level));
            expected += depth && *depth <= hit->depth;
        }
        EXPECT_EQ(picker.exact(ray, options, hit).chunks, expected);
    }
}

// Everything that an occluder or another cloud hides is left out.
TEST_P(PointPickerTest, EndsWhereTheRayOrAnotherHitEndsIt)
{
    PointPicker picker(cloud_->cache());
    std::mt19937_64 random(9);
    int nearer = 0;
    for (int i = 0; i < tries(600, 120); ++i) {
        SCOPED_TRACE(i);
        PickRay ray = random_ray(random);
        PickOptions options;
        const auto whole = picker.exact(ray, options).hit;
        if (!whole) continue;
        options.most_depth = whole->depth;
        const auto same = picker.exact(ray, options).hit;
        ASSERT_TRUE(same);
        EXPECT_EQ(same->index, whole->index);
        options.most_depth = std::nextafter(whole->depth, -std::numeric_limits<double>::infinity());
        EXPECT_FALSE(picker.exact(ray, options).hit);
        EXPECT_FALSE(picker.in_memory(ray, options).hit);
        EXPECT_FALSE(picker.exact(ray, options, whole).hit) << "a hit that is too deep is not taken over";
        options.most_depth = std::numeric_limits<double>::infinity();
        ray.end = std::nextafter(whole->along, -std::numeric_limits<double>::infinity());
        if (!(ray.end > ray.begin)) continue;
        const Record* expected = brute_force(
            ray, options, [](const Record&) { return true; }, nullptr);
        const auto found = picker.exact(ray, options).hit;
        ASSERT_EQ(found.has_value(), expected != nullptr);
        if (!expected) continue;
        ++nearer;
        EXPECT_EQ(std::tie(found->node, found->index), std::tie(expected->node, expected->index));
    }
    if (GetParam() == Cloud::volume) EXPECT_GT(nearer, tries(4, 0));
}

// A known hit is the answer where no point is nearer, even one of another cloud.
TEST_P(PointPickerTest, AKnownHitStandsWhereNothingIsNearer)
{
    PointPicker picker(cloud_->cache());
    std::mt19937_64 random(19);
    for (int i = 0; i < tries(200, 40); ++i) {
        SCOPED_TRACE(i);
        const PickRay ray = random_ray(random);
        const PickResult alone = picker.exact(ray);
        if (!alone.hit) continue;
        const PickResult again = picker.exact(ray, {}, alone.hit);
        ASSERT_TRUE(again.hit);
        EXPECT_EQ(std::tie(again.hit->node, again.hit->index), std::tie(alone.hit->node, alone.hit->index));
        EXPECT_EQ(again.hit->depth, alone.hit->depth);
        PickHit other = *alone.hit;
        other.index = 4000000000u;
        const double infinite = std::numeric_limits<double>::infinity();
        other.depth = std::nextafter(alone.hit->depth, -infinite);
        const PickResult nearer = picker.exact(ray, {}, other);
        ASSERT_TRUE(nearer.hit);
        EXPECT_EQ(nearer.hit->index, 4000000000u);
        EXPECT_EQ(nearer.outcome.points_out, 1u);
        other.depth = std::nextafter(alone.hit->depth, infinite);
        EXPECT_EQ(picker.exact(ray, {}, other).hit->index, alone.hit->index) << "a point is nearer";
    }
}

TEST_P(PointPickerTest, InMemoryReadsNothingAndKnowsAllOnceAllIsThere)
{
    read_again_in_pages(folder_ / "t.pct", cloud_);
    PointPicker picker(cloud_->cache());
    std::mt19937_64 random(10);
    const std::uint64_t loaded = cloud_->cache().statistics().loaded_bytes;
    for (int i = 0; i < 50; ++i) {
        const PickResult nothing = picker.in_memory(random_ray(random));
        EXPECT_FALSE(nothing.hit);
        EXPECT_EQ(nothing.chunks, 0u);
    }
    EXPECT_EQ(cloud_->cache().statistics().loaded_bytes, loaded);
    EXPECT_EQ(cloud_->tree()->nodes().pages_loaded(), 1u);
    cloud_->cache().set_capacity(64 << 20);
    for (NodeId id = 0; id < cloud_->tree()->nodes().size(); ++id)
        cloud_->cache().get(id, ColumnSet::whole(cloud_->info().schema));
    for (int i = 0; i < tries(300, 60); ++i) {
        const PickRay ray = random_ray(random);
        const PickResult first = picker.in_memory(ray), exact = picker.exact(ray);
        EXPECT_EQ(exact.read, 0u);
        ASSERT_EQ(first.hit.has_value(), exact.hit.has_value());
        if (first.hit) EXPECT_EQ(first.hit->index, exact.hit->index);
    }
}

TEST_P(PointPickerTest, ManyThreadsPickAtOnce)
{
    PointPicker picker(cloud_->cache());
    std::vector<std::thread> threads;
    std::atomic<int> wrong{0};
    for (unsigned seed = 0; seed < 4; ++seed)
        threads.emplace_back([&, seed] {
            std::mt19937_64 random(20 + seed);
            for (int i = 0; i < 40; ++i) {
                const PickRay ray = random_ray(random);
                PickOptions options;
                const Record* expected = brute_force(
                    ray, options, [](const Record&) { return true; }, nullptr);
                const auto hit = picker.exact(ray, options, picker.in_memory(ray, options).hit).hit;
                if (hit.has_value() != (expected != nullptr) ||
                    (hit && std::tie(hit->node, hit->index) != std::tie(expected->node, expected->index)))
                    ++wrong;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0);
}

INSTANTIATE_TEST_SUITE_P(Clouds, PointPickerTest,
                         testing::Values(Cloud::surface, Cloud::volume, Cloud::line, Cloud::duplicates,
                                         Cloud::coincident, Cloud::clusters, Cloud::full_range, Cloud::wide,
                                         Cloud::tiny, Cloud::radii, Cloud::groups, Cloud::single),
                         [](const auto& info) { return std::string(name(info.param)); });

// A wall of points in front of another: none of the second wall is ever picked, though its points lie nearer to the
// ray.
TEST(PointPicker, DoesNotPickThroughAClosedSurface)
{
    std::vector<LasRecord> points;
    for (int i = 0; i < 100; ++i)
        for (int j = 0; j < 100; ++j)
            for (const int z : {0, -37}) {
                LasRecord p{};
                p.x = 10 * i + (z ? 3 : 0), p.y = 10 * j + (z ? 4 : 0), p.z = z;
                points.push_back(p);
            }
    const TemporaryFolder folder;
    write_las(folder / "in.las", points, {{0.01, 0.01, 0.01}, {4e5, 5e6, 0}});
    build_tree({folder / "in.las"}, folder / "t.pct");
    const auto cloud = PointCloud::open(folder / "t.pct");
    PointPicker picker(cloud->cache());
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> inside(0.5, 9.4);
    for (int i = 0; i < tries(500, 100); ++i) {
        const PickRay ray = PickRay::along({4e5 + inside(random), 5e6 + inside(random), 20}, {0, 0, -1}, 0, 2e-4);
        const auto hit = picker.exact(ray).hit;
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->position[2], 0);
    }
}

TEST(PointPicker, RefusesOptionsThatMakeNoSenseAndCanBeCancelled)
{
    const TemporaryFolder folder;
    write_las(folder / "in.las", records(Shape::surface, 1000, 1), {{0.001, 0.001, 0.001}, {0, 0, 0}});
    build_tree({folder / "in.las"}, folder / "t.pct");
    const auto cloud = PointCloud::open(folder / "t.pct");
    PointPicker picker(cloud->cache());
    const PickRay ray = PickRay::along({50, 30, 100}, {0, 0, -1}, 0, 0.01);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double tolerance : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
        PickOptions options;
        options.tolerance_px = tolerance;
        EXPECT_THROW(picker.exact(ray, options), Error);
        EXPECT_THROW(picker.in_memory(ray, options), Error);
    }
    PickOptions options;
    options.largest_px = 3;
    EXPECT_THROW(picker.exact(ray, options), Error);
    options = {};
    options.size_scale = -1;
    EXPECT_THROW(picker.exact(ray, options), Error);
    options = {};
    options.most_depth = nan;
    EXPECT_THROW(picker.exact(ray, options), Error);
    options = {};
    options.where = {parse_condition("no_such=1")};
    EXPECT_THROW(picker.exact(ray, options), Error);
    options = {};
    options.cancelled = [] { return true; };
    try {
        picker.exact(ray, options);
        FAIL() << "not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
    EXPECT_TRUE(picker.exact(ray).hit);
}

}  // namespace
