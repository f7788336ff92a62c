#include "pcm/filter/neighbour_attributes.h"

#include "pcm/cloud/symmetric_eigen.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "pcm/tree/point_size.h"
#include "pcm/tree/verify.h"
#include "pcm/update/target.h"
#include "tests/filter/oracle.h"
#include "tests/outcome.h"
#include "tests/sanitizers.h"

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

Vec3d bumpy(double u, double v, double w)
{
    return {10 * u, 8 * v, 0.3 * std::sin(3 * u) + 0.2 * std::cos(5 * v) + 0.01 * w};
}

NeighbourAttributeOptions wanting(const WantedValues& wanted, std::size_t k = 16)
{
    NeighbourAttributeOptions options;
    options.wanted = wanted;
    options.neighbours = k;
    options.threads = 2;
    return options;
}

// Sums of products about the centroid of a point and its neighbours.
SymmetricMatrix scatter(const OracleNeighbours& n)
{
    long double x = 0, y = 0, z = 0;
    const long double points = static_cast<long double>(n.count() + 1);
    for (std::size_t j = 0; j < n.count(); ++j) x += n.x[j], y += n.y[j], z += n.z[j];
    x /= points, y /= points, z /= points;
    long double m[6] = {x * x, x * y, x * z, y * y, y * z, z * z};
    for (std::size_t j = 0; j < n.count(); ++j) {
        const long double a = n.x[j] - x, b = n.y[j] - y, c = n.z[j] - z;
        m[0] += a * a, m[1] += a * b, m[2] += a * c, m[3] += b * b, m[4] += b * c, m[5] += c * c;
    }
    return {double(m[0]), double(m[1]), double(m[2]), double(m[3]), double(m[4]), double(m[5])};
}

class NeighbourAttributes : public testing::Test {
protected:
    NeighbourAttributeReport compute(const NeighbourAttributeOptions& options)
    {
        const NeighbourAttributeReport report = compute_neighbour_attributes(tree_, options);
        const VerifyReport verified = verify_tree(tree_, 1);
        EXPECT_TRUE(verified.faults.empty()) << verified.faults.front();
        return report;
    }

    // Every value against comparing all pairs.
    void expect_exact(std::size_t k, double tolerance, double max_distance = HUGE_VAL) const
    {
        const Oracle oracle(tree_);
        std::size_t marked = 0;
        for (std::size_t i = 0; i < oracle.points.size(); ++i) {
            const OraclePoint& p = oracle.points[i];
            const OracleNeighbours n = oracle.neighbours(i, k, max_distance);
            const Vec3d normal = oracle.normal(p);
            double radius = 0, sum = 0;
            for (std::size_t j = 0; j < n.count(); ++j) {
                const Vec3d d{n.x[j], n.y[j], n.z[j]};
                radius = std::max(radius, length(d - dot(normal, d) * normal));
                sum += std::sqrt(n.squared[j]);
            }
            ASSERT_NEAR(oracle.value(p, "radius"), radius, tolerance * radius) << i;
            const double mean = n.count() ? sum / static_cast<double>(n.count()) : 0;
            ASSERT_NEAR(oracle.value(p, "mean_distance"), mean, tolerance * mean) << i;
            auto confidence = static_cast<NormalConfidence>(oracle.value(p, "normal_confidence"));
            if (confidence == NormalConfidence::two_surfaces) {  // noise, which may look so by chance
                ++marked;
                confidence = NormalConfidence::good;
            }
            const Eigensystem<3> axes = eigensystem(scatter(n));
            if (n.count() < 2 || axes.values[2] == 0) {
                ASSERT_EQ(confidence, NormalConfidence::too_few) << i;
                ASSERT_EQ(normal, (Vec3d{0, 0, 0})) << i;
                continue;
            }
            ASSERT_NEAR(length(normal), 1, 2e-7) << i;
            const double l0 = axes.values[0], l1 = axes.values[1], l2 = axes.values[2];
            ASSERT_EQ(confidence, l1 < 0.01 * l2  ? NormalConfidence::line
                                  : l0 > 0.4 * l1 ? NormalConfidence::blob
                                                  : NormalConfidence::good)
                << i;
            ASSERT_NEAR(oracle.value(p, "curvature"), l0 / (l0 + l1 + l2), tolerance) << i;
            if (l1 - l0 > 1e-3 * l2) ASSERT_LT(degrees(normal, axes.vectors[0]), 100 * tolerance) << i;
        }
        EXPECT_LE(marked, oracle.points.size() / 100);
    }

    const TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "cloud.pct";
};

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(NeighbourAttributes, PCM_NOT_UNDER_THREAD(AreThoseOfComparingAllPairs))
{
    for (const Vec3d& origin : {Vec3d{0, 0, 0}, Vec3d{500000, 4800000, 120}})
        for (const std::size_t k : {1, 2, 5, 16, 37}) {
            SCOPED_TRACE(std::to_string(k) + " neighbours at " + std::to_string(origin[1]));
            fs::remove_all(tree_);
            build_small(cloud_of(2500, 7, [&](double u, double v, double w) { return origin + bumpy(u, v, w); }),
                        tree_);
            const Stopwatch watch;
            const NeighbourAttributeReport report = compute(wanting(all_values(), k));
            expect_outcome(report.outcome, 2500, 2500, watch);
            EXPECT_GT(report.peak_memory_bytes, 1u << 20);
            expect_exact(k, 3e-7);
        }
}

TEST_F(NeighbourAttributes, OfVolumesAndWithinADistance)
{
    build_small(cloud_of(2000, 8, [](double u, double v, double w) { return Vec3d{u, v, w}; }), tree_);
    NeighbourAttributeOptions options = wanting(all_values(), 12);
    const NeighbourAttributeReport report = compute(options);
    EXPECT_GT(report.blobs, 1000u);  // no plane fits
    expect_exact(12, 3e-7);
    options.max_distance = 0.05;  // fewer than two neighbours for most
    EXPECT_GT(compute(options).too_few, 500u);
    expect_exact(12, 3e-7, 0.05);
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(NeighbourAttributes, PCM_NOT_UNDER_THREAD(OfTinyAndHugeClouds))
{
    for (const double extent : {1e-9, 1e-6, 1.0, 1e9}) {
        SCOPED_TRACE(extent);
        fs::remove_all(tree_);
        build_small(cloud_of(1500, 9, [&](double u, double v, double w) { return extent * bumpy(u, v, w); }), tree_);
        const NeighbourAttributeReport report = compute(wanting(all_values()));
        EXPECT_LT(report.blobs + report.lines + report.too_few, 150u);
        expect_exact(16, 5e-7);
    }
}

TEST_F(NeighbourAttributes, OfDegenerateNeighbourhoods)
{
    struct Case {
        std::size_t points;
        std::function<Vec3d(double, double, double)> f;
        std::uint64_t lines, too_few;
    };
    const auto constant = [](double, double, double) { return Vec3d{1, 2, 3}; };
    const auto line = [](double u, double, double) { return Vec3d{3 * u, 4 * u, 12 * u}; };
    const auto steep = [](double u, double, double) { return Vec3d{5, 6, std::floor(400 * u)}; };
    const Case cases[] = {{1, constant, 0, 1},   {2, line, 0, 2},     {3, line, 3, 0},
                          {60, constant, 0, 60}, {300, line, 300, 0}, {300, steep, 300, 0}};
    for (const Case& one : cases) {
        fs::remove_all(tree_);
        build_small(cloud_of(one.points, 10, one.f), tree_);
        NeighbourAttributeOptions options = wanting(all_values());
        const NeighbourAttributeReport report = compute(options);
        EXPECT_EQ(report.lines, one.lines) << one.points;
        EXPECT_EQ(report.too_few, one.too_few) << one.points;
        expect_exact(16, 1e-6);
        const Oracle oracle(tree_);
        for (const OraclePoint& p : oracle.points)
            for (const char* name : {"radius", "curvature", "mean_distance"})
                EXPECT_TRUE(std::isfinite(oracle.value(p, name))) << name;
    }
    // Along a line in space the normal is the one nearest to the z axis.
    fs::remove_all(tree_);
    build_small(cloud_of(300, 10, line), tree_);
    compute(wanting(all_values()));
    const Oracle oracle(tree_);
    for (const OraclePoint& p : oracle.points) EXPECT_NEAR(oracle.normal(p)[2], 5.0 / 13, 1e-3);
}

TEST_F(NeighbourAttributes, RadiiAreMeasuredAcrossKnownNormals)
{
    MemoryCloud cloud = cloud_of(1200, 11, bumpy);
    Schema schema;
    schema.add({"normal", ScalarType::i8, 3, 1.0 / 127, 0, ""});  // length not 1: not computed here
    cloud.info.schema = schema;
    cloud.points.attributes.emplace_back(schema[0]);
    cloud.points.attributes[0].resize(1200);
    std::mt19937_64 random(3);
    for (std::size_t i = 0; i < 3600; ++i)
        cloud.points.attributes[0].as<std::int8_t>()[i] = i < 30 ? 0 : static_cast<std::int8_t>(random() % 200 - 100);
    build_small(cloud, tree_);
    WantedValues radii;
    radii.radius = true;
    EXPECT_TRUE(compute(wanting(radii, 9)).used_known_normals);
    const Oracle oracle(tree_);
    std::size_t without = 0;
    for (std::size_t i = 0; i < oracle.points.size(); ++i) {
        const OracleNeighbours n = oracle.neighbours(i, 9);
        Vec3d normal = oracle.normal(oracle.points[i]);
        if (length(normal) > 0)
            normal = normalised(normal);
        else
            ++without;
        double radius = 0;
        for (std::size_t j = 0; j < n.count(); ++j) {
            const Vec3d d{n.x[j], n.y[j], n.z[j]};
            radius = std::max(radius, length(d - dot(normal, d) * normal));
        }
        ASSERT_NEAR(oracle.value(oracle.points[i], "radius"), radius, 2e-7 * radius);
    }
    EXPECT_GE(without, 10u);
}

TEST_F(NeighbourAttributes, ARadiusMayCoverFewerNeighboursThanANormal)
{
    for (const bool normals : {true, false}) {
        fs::remove_all(tree_);
        build_small(cloud_of(600, 14, bumpy), tree_);
        WantedValues wanted;
        wanted.normal = normals;
        wanted.radius = true;
        wanted.radius_neighbours = 4;
        compute(wanting(wanted, 9));
        const Oracle oracle(tree_);
        for (std::size_t i = 0; i < oracle.points.size(); ++i) {
            const OracleNeighbours n = oracle.neighbours(i, 4);
            const Vec3d normal = normals ? oracle.normal(oracle.points[i]) : Vec3d{0, 0, 0};
            double radius = 0;
            for (std::size_t j = 0; j < n.count(); ++j) {
                const Vec3d d{n.x[j], n.y[j], n.z[j]};
                radius = std::max(radius, length(d - dot(normal, d) * normal));
            }
            ASSERT_NEAR(oracle.value(oracle.points[i], "radius"), radius, 1e-5 * radius);
        }
    }
}

TEST_F(NeighbourAttributes, RadiiOfPointsThatStandAloneAreLimited)
{
    MemoryCloud cloud = cloud_of(1200, 15, bumpy);
    for (std::size_t i = 0; i < 5; ++i) cloud.points.xyz[2][i] += 1e3 * double(i + 1);
    build_small(cloud, tree_);
    WantedValues wanted;
    wanted.normal = wanted.radius = true;
    compute(wanting(wanted, 6));
    const Oracle free(tree_);
    NeighbourAttributeOptions options = wanting(wanted, 6);
    options.radius_limit = 3;
    const std::uint64_t limited = compute(options).limited;
    EXPECT_GE(limited, 5u);
    EXPECT_LT(limited, 120u);
    const Oracle bounded(tree_);
    const double least = least_point_size(bounded.tree->info().grid);
    ColumnSet sizes;
    sizes.positions = false;
    sizes.sizes = true;
    std::uint64_t smaller = 0;
    for (std::size_t i = 0; i < bounded.points.size(); ++i) {
        const OraclePoint& p = bounded.points[i];
        const double before = free.value(free.points[i], "radius"), after = bounded.value(p, "radius");
        const Chunk chunk = bounded.tree->read_chunk(p.node, sizes);
        const double most = 3 * point_size(chunk.sizes->as<std::uint8_t>()[p.index], least);
        ASSERT_NEAR(after, std::min(before, most), 1e-6 * after);
        smaller += after < before;
    }
    EXPECT_EQ(smaller, limited);
    options.radius_limit = -1;
    EXPECT_THROW(compute(options), Error);
}

TEST_F(NeighbourAttributes, ReplaceValuesOfTheirTypeAndRefuseOthers)
{
    build_small(cloud_of(1200, 12, bumpy), tree_);
    WantedValues radii;
    radii.radius = true;
    compute(wanting(radii, 3));
    const Oracle before(tree_);
    compute(wanting(radii, 30));
    const Oracle after(tree_);
    EXPECT_EQ(after.tree->info().schema.size(), 1u);
    for (std::size_t i = 0; i < after.points.size(); ++i)
        EXPECT_GT(after.value(after.points[i], "radius"), before.value(before.points[i], "radius"));

    const auto cloud = PointCloud::open(tree_, {}, Access::write);
    cloud->add_attribute({"curvature", ScalarType::u16, 1, 1, 0, ""});
    cloud->close();
    const auto generation = Tree::open(tree_)->info().generation;
    try {
        compute_neighbour_attributes(tree_, wanting(all_values()));
        FAIL() << "not refused";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find("'curvature' exists with another type (u16)"), std::string::npos)
            << error.what();
    }
    EXPECT_EQ(Tree::open(tree_)->info().generation, generation);
    EXPECT_EQ(Tree::open(tree_)->info().schema.size(), 2u);
}

TEST_F(NeighbourAttributes, NormalsPointWhereTheyAreToldTo)
{
    const Vec3d centre{500010, 4800020, 100};
    build_small(cloud_of(3000, 13,
                         [&](double u, double v, double) {
                             const double z = 2 * u - 1, r = std::sqrt(1 - z * z), a = 2 * pi * v;
                             return centre + Vec3d{r * std::cos(a), r * std::sin(a), z};
                         }),
                tree_);
    WantedValues normals;
    normals.normal = true;
    NeighbourAttributeOptions options = wanting(normals);
    const auto expect = [&](const std::function<double(const Vec3d& n, const Vec3d& p)>& side) {
        compute(options);
        const Oracle oracle(tree_);
        double angle = 0;
        for (const OraclePoint& p : oracle.points) {
            const Vec3d n = oracle.normal(p), out = oracle.position(p) - centre;
            EXPECT_GE(side(n, oracle.position(p)), -1e-6);
            angle = std::max(angle, degrees(n, out));
        }
        EXPECT_LT(angle, 8);
    };
    expect([&](const Vec3d& n, const Vec3d& p) { return dot(n, p - centre); });  // the default: outward
    options.orientation.rule = NormalOrientation::Rule::direction;
    expect([](const Vec3d& n, const Vec3d&) { return n[2]; });
    options.orientation = {NormalOrientation::Rule::direction, {-3, 0, 0}};
    expect([](const Vec3d& n, const Vec3d&) { return -n[0]; });
    options.orientation = {NormalOrientation::Rule::viewpoint, centre};
    expect([&](const Vec3d& n, const Vec3d& p) { return dot(n, centre - p); });
    options.orientation = {NormalOrientation::Rule::viewpoint, centre + Vec3d{3, 0, 0}};
    expect([&](const Vec3d& n, const Vec3d& p) { return dot(n, centre + Vec3d{3, 0, 0} - p); });
}

TEST_F(NeighbourAttributes, DoNotDependOnTheThreads)
{
    build_small(cloud_of(8000, 14, bumpy), tree_);
    fs::copy(tree_, folder_ / "other.pct", fs::copy_options::recursive);
    NeighbourAttributeOptions options = wanting(all_values());
    options.threads = 1;
    compute(options);
    options.threads = 5;
    options.memory_bytes = 200000;  // most chunks are written before the end
    compute_neighbour_attributes(folder_ / "other.pct", options);
    EXPECT_EQ(Tree::open(tree_)->info().content_hash, Tree::open(folder_ / "other.pct")->info().content_hash);
}

TEST_F(NeighbourAttributes, ACancelledRunLeavesTheTree)
{
    build_small(cloud_of(8000, 15, bumpy), tree_);
    const auto before = Tree::open(tree_)->info();
    NeighbourAttributeOptions options = wanting(all_values());
    options.memory_bytes = 200000;
    std::vector<double> stops{0.2, 0.5, 0.94};
    for (const double stop : stops) {
        options.progress = [&](const ProgressUpdate& update) { return update.fraction < stop; };
        try {
            compute_neighbour_attributes(tree_, options);
            FAIL() << "not cancelled at " << stop;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::cancelled) << error.what();
        }
        EXPECT_EQ(Tree::open(tree_)->info().generation, before.generation);
        EXPECT_EQ(Tree::open(tree_)->info().content_hash, before.content_hash);
        EXPECT_TRUE(verify_tree(tree_, 1).faults.empty());
        for (const auto& entry : fs::directory_iterator(tree_))
            EXPECT_TRUE(entry.path().extension() == ".pct" || entry.path().extension() == ".bpc" ||
                        entry.path().filename() == lock_file_name)
                << entry.path();
    }
    UpdateTarget(tree_, {folder_ / "copy.pct", false});  // not kept
    EXPECT_FALSE(fs::exists(folder_ / "copy.pct"));
}

TEST_F(NeighbourAttributes, OptionsOutOfRangeAreRefused)
{
    build_small(cloud_of(100, 16, bumpy), tree_);
    const auto refused = [&](const std::function<void(NeighbourAttributeOptions&)>& change) {
        NeighbourAttributeOptions options = wanting(all_values());
        change(options);
        try {
            compute_neighbour_attributes(tree_, options);
        } catch (const Error& error) {
            return error.code() == ErrorCode::invalid_argument;
        }
        return false;
    };
    EXPECT_TRUE(refused([](auto& options) { options.wanted = {}; }));
    EXPECT_TRUE(refused([](auto& options) { options.neighbours = 0; }));
    EXPECT_TRUE(refused([](auto& options) { options.neighbours = most_neighbours + 1; }));
    EXPECT_TRUE(refused([](auto& options) { options.max_distance = 0; }));
    EXPECT_TRUE(refused([](auto& options) { options.max_distance = std::nan(""); }));
    EXPECT_TRUE(refused([](auto& options) { options.orientation = {NormalOrientation::Rule::direction, {0, 0, 0}}; }));
    EXPECT_TRUE(refused([](auto& options) { options.orientation.vector = {0, 0, HUGE_VAL}; }));
    EXPECT_FALSE(refused([](auto&) {}));
}

}  // namespace
