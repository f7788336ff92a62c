// Queries of trees against a test of every point: regions, levels, conditions, estimates, neighbours, first hits.

#include "pcm/build/builder.h"
#include "pcm/cloud/vector.h"
#include "pcm/generate/scene.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "tests/clouds.h"
#include "tests/memory_reader.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <random>
#include <thread>

namespace {

using namespace pcm;
using namespace pcm::test;

struct Record {
    NodeId node;
    std::uint32_t index;
    std::uint16_t level;
    Vec3d position;
    double intensity;
};

enum class Cloud { city, surface, volume, line, plane, duplicates, coincident, clusters, full_range, wide, single };

const char* name(Cloud cloud)
{
    static const char* names[] = {"city",       "surface",  "volume",     "line", "plane", "duplicates",
                                  "coincident", "clusters", "full_range", "wide", "single"};
    return names[static_cast<int>(cloud)];
}

Shape shape_of(Cloud cloud)
{
    switch (cloud) {
        case Cloud::volume:
            return Shape::volume;
        case Cloud::line:
            return Shape::line;
        case Cloud::duplicates:
            return Shape::duplicates;
        case Cloud::coincident:
            return Shape::coincident;
        case Cloud::clusters:
            return Shape::clusters;
        case Cloud::full_range:
            return Shape::full_range;
        default:
            return Shape::surface;
    }
}

class QueryTest : public testing::TestWithParam<Cloud> {
protected:
    void SetUp() override
    {
        const std::filesystem::path out = folder_ / "t.pct";
        BuildOptions options;
        options.chunk_points = 2000;
        options.threads = 2;
        options.memory_bytes = 64 << 20;
        const Cloud kind = GetParam();
        if (kind == Cloud::city) {
            SceneOptions scene;
            scene.points = 20000;
            scene.threads = 2;
            generate_scene(folder_ / "in.las", scene, false);
            build_tree({folder_ / "in.las"}, out, options);
        } else if (kind == Cloud::wide) {
            // Clusters of a thousandth in a box of 1e9: positions of 64 bits.
            Schema schema;
            schema.add({"intensity", ScalarType::u16, 1, 1, 0, ""});
            MemoryCloud cloud = random_cloud(schema, std::nullopt, 9000, 5, 1e9);
            for (std::size_t i = 0; i < 6000; ++i)
                for (std::size_t a = 0; a < 3; ++a) {
                    double& c = cloud.points.xyz[a][i];
                    c = (i % 3 ? 9e8 : -9e8) + std::fmod(c, 1.0) * 1e-3;
                }
            MemoryReader reader(cloud);
            build_tree(reader, {"memory"}, out, options);
        } else {
            Grid grid{{0.001, 0.001, 0.001}, {5e6, 4.8e6, 0}};
            if (kind == Cloud::clusters || kind == Cloud::full_range) grid.offset = {-3, 7, 0.5};
            auto points = records(shape_of(kind), kind == Cloud::single ? 1 : 9000, 3);
            if (kind == Cloud::plane)
                for (LasRecord& p : points) p.x = p.x / 500 * 500, p.y = p.y / 500 * 500, p.z = 0;  // a lattice: ties
            write_las(folder_ / "in.las", points, grid);
            build_tree({folder_ / "in.las"}, out, options);
        }
        L2Options cache;
        cache.capacity_bytes = 60000;  // a few chunks of them
        cloud_ = PointCloud::open(out, cache);
        const Tree& tree = *cloud_->tree();
        const std::size_t intensity = *tree.info().schema.find("intensity");
        ColumnSet columns;
        columns.attributes.set(intensity);
        for (NodeId id = 0; id < tree.nodes().size(); ++id) {
            const Chunk chunk = tree.read_chunk(id, columns);
            std::uint32_t i = 0;
            for (std::size_t k = 0; k < tree.node(id).level_points.size(); ++k)
                for (const std::uint32_t end = i + tree.node(id).level_points[k]; i < end; ++i)
                    all_.push_back({id, i, static_cast<std::uint16_t>(tree.node(id).first_level + k),
                                    tree.info().grid.to_source(chunk.positions->grid(i)),
                                    chunk.attributes[intensity]->value(i)});
        }
        ASSERT_EQ(all_.size(), tree.info().points);
        bounds_ = tree.info().bounds();
        size_ = std::max(bounds_.diagonal(), 1e-3);
    }

    struct Random {
        std::mt19937_64 bits;
        double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
        double between(double a, double b) { return a + (b - a) * unit(); }
        std::size_t below(std::size_t n) { return bits() % n; }
        Vec3d vector() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }
        Vec3d direction()
        {
            Vec3d v = vector();
            if (below(3) == 0) v = {0, 0, below(2) ? 1.0 : -1.0};
            return v;
        }
    };
    // A point of the cloud, one near it, or one anywhere.
    Vec3d place(Random& random) const
    {
        Vec3d p = all_[random.below(all_.size())].position;
        const std::size_t where = random.below(3);
        const Vec3d d = random.vector();
        const double away = where == 0 ? 0 : where == 1 ? size_ * std::pow(10, random.between(-9, -1)) : size_;
        for (std::size_t a = 0; a < 3; ++a) p[a] += away * d[a];
        return p;
    }
    double length(Random& random) const { return size_ * std::pow(10, random.between(-7, 0)); }

    Region region(Random& random) const
    {
        const Vec3d p = place(random), u = random.direction();
        const double r = length(random);
        const std::optional<double> end = random.below(2) ? std::optional(length(random) * 3) : std::nullopt;
        switch (random.below(7)) {
            case 0:
                return Region::box(
                    {{p[0] - r, p[1] - r * random.unit(), p[2] - r}, {p[0] + r, p[1] + r, p[2] + r * random.unit()}});
            case 1: {
                const double turn = random.between(0, 6);
                return Region::oriented_box(p,
                                            {Vec3d{std::cos(turn), std::sin(turn), 0},
                                             Vec3d{-std::sin(turn), std::cos(turn), 0}, Vec3d{0, 0, 1}},
                                            {r, r * random.unit(), size_ * random.unit()});
            }
            case 2:
                return Region::ray(p, u, r * 0.3, end);
            case 3:
                return Region::cone(p, u, random.below(4) ? random.between(0.01, 89) : random.between(89, 89.999999),
                                    end);
            case 4: {
                Vec3d target = p;
                for (std::size_t a = 0; a < 3; ++a) target[a] += size_ * u[a];
                if (target == p) target[2] += 1;
                return Region::frustum(p, target, {0.3, 0.2, 0.9}, random.between(1, 120), random.between(0.3, 3),
                                       r * 0.01, r * 4);
            }
            case 5:
                return Region::convex(p, {{u, 0}, {random.vector(), r}, {random.vector(), r}});
            default:
                return Region::sphere(p, r);
        }
    }
    Query query(Random& random) const
    {
        Query query;
        if (random.below(8)) query.region = region(random);
        if (random.below(3) == 0) {
            query.box.emplace();
            query.box->extend(place(random));
            query.box->extend(place(random));
        }
        if (random.below(3) == 0) query.level = static_cast<std::uint16_t>(random.below(cloud_->info().levels));
        if (random.below(4) == 0)
            query.where.push_back(parse_condition("intensity>=" + std::to_string(random.below(65536))));
        if (random.below(6) == 0)
            query.where.push_back(
                parse_condition("z" + std::string(random.below(2) ? "<" : ">=") + std::to_string(place(random)[2])));
        if (random.below(2)) query.attributes = {"intensity"};
        query.reads_in_flight = static_cast<unsigned>(1 + random.below(6));
        return query;
    }
    std::vector<Record> expected(const Query& query) const
    {
        std::vector<Record> result;
        for (const Record& r : all_) {
            bool wanted = !query.level || r.level <= *query.level;
            wanted = wanted && (!query.box || query.box->contains(r.position)) &&
                     (!query.region || query.region->contains(r.position));
            for (const Condition& c : query.where) {
                const double v = c.name == "z" ? r.position[2] : r.intensity;
                const auto& range = c.ranges[0];
                wanted =
                    wanted && (c.relation == Condition::Relation::less ? v < range.high->value : v >= range.low->value);
            }
            if (wanted) result.push_back(r);
        }
        return result;
    }

    void check(const Query& query) const
    {
        const std::vector<Record> wanted = expected(query);
        for (const EstimatePrecision precision : {EstimatePrecision::index, EstimatePrecision::headers}) {
            const Estimate estimate = cloud_->estimate(query, precision);
            ASSERT_LE(estimate.points_least, wanted.size());
            ASSERT_GE(estimate.points_most, wanted.size());
            ASSERT_LE(estimate.points_most, estimate.points_read);
            ASSERT_LE(estimate.chunks_cached, estimate.chunks);
            ASSERT_LE(estimate.points_expected, static_cast<double>(estimate.points_most) + 1e-6);
            ASSERT_GE(estimate.points_expected, static_cast<double>(estimate.points_least) - 1e-6);
        }
        std::vector<Record> found;
        auto cursor = cloud_->points(query);
        PointView view;
        while (cursor.getNextData(view)) {
            ASSERT_GT(view.size(), 0u);
            for (std::size_t i = 0; i < view.size(); ++i)
                found.push_back({view.node(), view.number(i), 0, view.position(i),
                                 query.attributes.empty() ? 0 : view.value(i, 0)});
        }
        ASSERT_EQ(found.size(), wanted.size()) << (query.region ? query.region->text() : "");
        for (std::size_t i = 0; i < found.size(); ++i) {
            ASSERT_TRUE(found[i].node == wanted[i].node && found[i].index == wanted[i].index &&
                        found[i].position == wanted[i].position);
            if (!query.attributes.empty()) ASSERT_EQ(found[i].intensity, wanted[i].intensity);
        }
    }

    std::vector<Neighbour> neighbours(const Vec3d& q, std::size_t k, const NearestOptions& options) const
    {
        std::vector<Neighbour> result;
        for (const Record& r : all_) {
            const double d = squared_distance(r.position, q);
            if ((!options.level || r.level <= *options.level) && d <= options.max_distance * options.max_distance)
                result.push_back({r.node, r.index, d, r.position});
        }
        const auto before = [](const Neighbour& a, const Neighbour& b) {
            return std::tie(a.squared_distance, a.node, a.index) < std::tie(b.squared_distance, b.node, b.index);
        };
        const auto middle = result.begin() + static_cast<std::ptrdiff_t>(std::min(k, result.size()));
        std::partial_sort(result.begin(), middle, result.end(), before);
        result.erase(middle, result.end());
        return result;
    }
    static bool same(const Neighbour* a, const Neighbour* b, std::size_t n)
    {
        for (std::size_t i = 0; i < n; ++i)
            if (a[i].node != b[i].node || a[i].index != b[i].index || a[i].squared_distance != b[i].squared_distance ||
                a[i].position != b[i].position)
                return false;
        return true;
    }

    TemporaryFolder folder_;
    std::shared_ptr<PointCloud> cloud_;
    std::vector<Record> all_;
    Box3d bounds_;
    double size_ = 1;
};

INSTANTIATE_TEST_SUITE_P(Clouds, QueryTest,
                         testing::Values(Cloud::city, Cloud::surface, Cloud::volume, Cloud::line, Cloud::plane,
                                         Cloud::duplicates, Cloud::coincident, Cloud::clusters, Cloud::full_range,
                                         Cloud::wide, Cloud::single),
                         [](const auto& info) { return name(info.param); });

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_P(QueryTest, PCM_NOT_UNDER_THREAD(FindsTheSelectedPoints))
{
    Random random{std::mt19937_64(1)};
    for (int round = 0; round < 500 && !HasFatalFailure(); ++round) check(query(random));
}

TEST_P(QueryTest, FromManyThreadsAtOnce)
{
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < 4; ++t)
        threads.emplace_back([this, t] {
            Random random{std::mt19937_64(100 + t)};
            for (int round = 0; round < tries(60, 15) && !HasFatalFailure(); ++round) {
                check(query(random));
                const Vec3d q = place(random);
                const auto found = cloud_->nearest(q, 5).points;
                const auto wanted = neighbours(q, 5, {});
                ASSERT_EQ(found.size(), wanted.size());
                ASSERT_TRUE(same(found.data(), wanted.data(), found.size()));
            }
        });
    for (std::thread& thread : threads) thread.join();
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_P(QueryTest, PCM_NOT_UNDER_THREAD(NeighboursInOrderTiesAndAll))
{
    Random random{std::mt19937_64(2)};
    const std::size_t levels = cloud_->info().levels;
    for (int round = 0; round < 400; ++round) {
        const Vec3d q = place(random);
        NearestOptions options;
        if (random.below(3) == 0) options.level = static_cast<std::uint16_t>(random.below(levels + 1));
        if (random.below(4) == 0) options.max_distance = length(random);
        std::size_t k = 1 + random.below(20);
        if (round % 50 == 0) k = all_.size() + 5;
        if (round % 50 == 1) k = 0;
        const NearestResult result = cloud_->nearest(q, k, options);
        const auto wanted = neighbours(q, k, options);
        ASSERT_EQ(result.points.size(), wanted.size());
        ASSERT_TRUE(same(result.points.data(), wanted.data(), wanted.size())) << "round " << round << " k " << k;
        // The promises about the whole cloud.
        if (k == 0) continue;
        const auto whole = neighbours(q, k, {});
        ASSERT_LE(result.least_distance, whole[0].distance() * (1 + 1e-12));
        for (std::size_t i = 0; i < wanted.size(); ++i)
            ASSERT_LE(whole[i].squared_distance, wanted[i].squared_distance);
        if (!wanted.empty()) {
            ASSERT_LE(wanted[0].distance() - whole[0].distance(),
                      result.outcome.error * (1 + 1e-9) + 1e-15 * wanted[0].distance());
            if (options.level)
                ASSERT_LE(result.outcome.error,
                          *options.level < levels ? cloud_->info().spacings[*options.level] * (1 + 1e-9) : 0);
        }
        if (!options.level) ASSERT_EQ(result.outcome.error, 0);
    }
}

TEST_P(QueryTest, ManyNeighboursAtOnceAreTheSame)
{
    Random random{std::mt19937_64(3)};
    std::vector<Vec3d> points;
    for (int i = 0; i < 600; ++i) points.push_back(place(random));
    NearestOptions options;
    for (const unsigned threads : {1u, 3u}) {
        options.threads = threads;
        if (threads == 3) options.level = static_cast<std::uint16_t>(cloud_->info().levels / 2);
        const NearestBatch batch = cloud_->nearest(points, 4, options);
        ASSERT_EQ(batch.first.size(), points.size() + 1);
        double error = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const NearestResult one = cloud_->nearest(points[i], 4, options);
            ASSERT_EQ(batch.first[i + 1] - batch.first[i], one.points.size());
            ASSERT_TRUE(same(&batch.points[batch.first[i]], one.points.data(), one.points.size()));
            ASSERT_EQ(batch.least_distance[i], one.least_distance);
            error = std::max(error, one.outcome.error);
        }
        EXPECT_EQ(batch.outcome.error, error);
    }
}

TEST_P(QueryTest, FirstHits)
{
    Random random{std::mt19937_64(4)};
    std::size_t hits = 0;
    for (int round = 0; round < 250; ++round) {
        const Vec3d p = place(random);
        Vec3d towards = random.direction();
        if (random.below(2)) {
            const Vec3d target = place(random);
            for (std::size_t a = 0; a < 3; ++a) towards[a] = target[a] - p[a];
            if (towards == Vec3d{0, 0, 0}) towards = {1, 0, 0};
        }
        const Region beam = random.below(2) ? Region::ray(p, towards, length(random) * 0.1)
                                            : Region::cone(p, towards, random.between(0.01, 20));
        const std::optional<std::uint16_t> level =
            random.below(3) ? std::nullopt
                            : std::optional(static_cast<std::uint16_t>(random.below(cloud_->info().levels)));
        std::optional<std::tuple<double, NodeId, std::uint32_t>> wanted;
        for (const Record& r : all_)
            if ((!level || r.level <= *level) && beam.contains(r.position)) {
                const auto candidate = std::make_tuple(beam.along(r.position), r.node, r.index);
                if (!wanted || candidate < *wanted) wanted = candidate;
            }
        const HitResult result = cloud_->first_hit(beam, level);
        ASSERT_EQ(result.hit.has_value(), wanted.has_value()) << beam.text();
        if (wanted)
            ASSERT_EQ(std::make_tuple(result.hit->along, result.hit->node, result.hit->index), *wanted) << beam.text();
        hits += wanted.has_value();
    }
    if (GetParam() != Cloud::single) EXPECT_GT(hits, 20u);
}

}  // namespace
