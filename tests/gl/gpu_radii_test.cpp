// Radii from compute shaders against comparing all pairs in double.
#include "tests/clouds.h"
#include "tests/gl/gpu_support.h"

#include "pcm/build/builder.h"
#include "pcm/gl/gl_state.h"
#include "pcm/gl/gpu_radii.h"
#include "pcm/tree/verify.h"
#include "pcm/update/append.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

using namespace pcm;
using namespace pcm::test;

namespace {

#define PCM_REQUIRE_COMPUTE                 \
    PCM_REQUIRE_GL(context, Profile::core); \
    try {                                   \
        require_compute_shaders();          \
    } catch (const Error& error) {          \
        GTEST_SKIP() << error.what();       \
    }

struct Points {
    std::vector<Vec3i> steps;
    std::vector<Vec3d> normals;  // empty without
    std::vector<float> radii;
    Vec3d scale{};
};

Points read(const std::filesystem::path& tree)
{
    const auto cloud = PointCloud::open(tree);
    const Schema& schema = cloud->info().schema;
    Points points;
    points.scale = cloud->info().grid.scale;
    for (NodeId id = 0; id < cloud->tree()->nodes().size(); ++id) {
        const auto chunk = cloud->cache().get(id, ColumnSet::all(schema));
        for (std::uint32_t i = 0; i < chunk->points; ++i) {
            points.steps.push_back(chunk->positions->grid(i));
            points.radii.push_back(static_cast<float>(chunk->attributes[*schema.find("radius")]->value(i)));
            if (const auto place = schema.find("normal")) {
                Vec3d n;
                for (std::uint32_t c = 0; c < 3; ++c) n[c] = chunk->attributes[*place]->value(i, c);
                points.normals.push_back(length(n) > 0 ? normalised(n) : n);
            }
        }
    }
    return points;
}

struct Neighbour {
    double square, across;  // squared distance; distance from the line along the normal
    bool operator<(const Neighbour& o) const { return std::pair(square, across) < std::pair(o.square, o.across); }
};

// The smallest and the largest radius that the point may have: of neighbours at equal distance any may be chosen.
std::pair<double, double> exact_radius(const Points& points, std::size_t p, std::size_t k)
{
    std::vector<Neighbour> all;
    for (std::size_t i = 0; i < points.steps.size(); ++i) {
        if (i == p) continue;
        Vec3d d;
        for (std::size_t a = 0; a < 3; ++a)
            d[a] = static_cast<double>(points.steps[i][a] - points.steps[p][a]) * points.scale[a];
        const double square = dot(d, d);
        if (!points.normals.empty()) d = d - dot(points.normals[p], d) * points.normals[p];
        all.push_back({square, length(d)});
    }
    k = std::min(k, all.size());
    if (k == 0) return {0, 0};
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(k - 1), all.end());
    const double last = all[k - 1].square;
    double least = 0, most = 0;
    for (std::size_t i = 0; i < k; ++i) least = std::max(least, all[i].across);
    for (const Neighbour& n : all)
        if (n.square <= last) most = std::max(most, n.across);
    return {least, most};
}

// Of all points, or of so many.
void check(const Points& points, std::size_t k, std::size_t sample = 0)
{
    std::mt19937_64 random(sample);
    double worst = 0;
    const std::size_t count = sample ? sample : points.steps.size();
    for (std::size_t j = 0; j < count; ++j) {
        const std::size_t p = sample ? random() % points.steps.size() : j;
        const auto [least, most] = exact_radius(points, p, k);
        const auto r = static_cast<double>(points.radii[p]);
        ASSERT_TRUE(std::isfinite(r));
        ASSERT_GE(r, least * (1 - 1e-5)) << "point " << p << " of " << points.steps.size();
        ASSERT_LE(r, most * (1 + 1e-5)) << "point " << p << " of " << points.steps.size();
        if (least == most && most > 0) worst = std::max(worst, std::abs(r / most - 1));
    }
    EXPECT_LT(worst, 1e-6);
}

// Gives every point some normal; the numbers are not of length 1, and every tenth is 0.
void add_normals(const std::filesystem::path& tree)
{
    const auto cloud = PointCloud::open(tree, {}, Access::write);
    cloud->add_attribute({"normal", ScalarType::f32, 3});
    Query query;
    query.attributes = {"normal"};
    std::mt19937_64 random(3);
    auto cursor = cloud->edit(query);
    for (EditView view; cursor.getNextData(view); view.mark_written())
        for (std::size_t i = 0; i < view.size(); ++i)
            for (std::uint32_t c = 0; c < 3; ++c)
                view.set(i, 0, i % 10 ? static_cast<float>(random() % 2001) - 1000.0f : 0.0f, c);
    cloud->close();
}

GpuRadiiReport compute(const std::filesystem::path& tree, std::size_t k, std::uint64_t l1_bytes = 16 * megabyte)
{
    GpuRadiiOptions options;
    options.neighbours = k;
    const auto cloud = PointCloud::open(tree, {}, Access::write);
    options.normals = cloud->info().schema.find("normal").has_value();
    const auto l1 = make_l1(l1_bytes);
    const GpuRadiiReport report = compute_radii_on_gpu(cloud, l1, options);
    EXPECT_EQ(report.outcome.points_out, cloud->info().points);
    cloud->close();
    EXPECT_LE(l1->statistics().allocated_bytes, l1_bytes);
    l1->release();
    EXPECT_EQ(drain_gl_errors(), "");
    return report;
}

// Without and with normals.
void compute_and_check(const std::filesystem::path& tree, std::size_t k, std::size_t sample = 0)
{
    compute(tree, k);
    check(read(tree), k, sample);
    add_normals(tree);
    compute(tree, k);
    check(read(tree), k, sample);
}

std::filesystem::path build(const TemporaryFolder& folder, const std::string& name,
                            const std::vector<std::filesystem::path>& files, std::uint32_t chunk_points)
{
    BuildOptions options;
    options.chunk_points = chunk_points;
    options.threads = 2;
    options.memory_bytes = 128 * megabyte;
    build_tree(files, folder / name, options);
    return folder / name;
}

}  // namespace

TEST(GpuRadii, AreThoseOfTheNearestPointsWhateverTheShape)
{
    PCM_REQUIRE_COMPUTE
    for (const Shape shape : {Shape::surface, Shape::volume, Shape::line, Shape::coincident, Shape::duplicates,
                              Shape::clusters, Shape::full_range}) {
        SCOPED_TRACE(name(shape));
        const TemporaryFolder folder;
        write_las(folder / "cloud.las", records(shape, 6000, 5), grid);
        const auto tree = build(folder, "cloud.pct", {folder / "cloud.las"}, 1000);
        compute_and_check(tree, 8);
    }
}
