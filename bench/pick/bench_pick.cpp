// Picks along random rays, from a cold cache, compared with a look at every point: the same point, and how long it
// took. Prints a table; see README.md.
#include "bench/pick/pick_levels.h"
#include "pcm/pick/point_picker.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "pcm/threads/for_each_index.h"
#include "pcm/threads/thread_count.h"
#include "pcm/view/camera_path.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <mutex>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#if defined(__x86_64__)
#define PCM_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define PCM_CLONES
#endif

namespace {

using namespace pcm;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Through random pixels of views of 1280 x 720 from random sides: of all the cloud to a hundredth of it.
std::vector<PickRay> random_rays(const Box3d& box, std::size_t count, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> normal;
    std::vector<PickRay> rays;
    while (rays.size() < count) {
        CameraFrame frame;
        for (std::size_t a = 0; a < 3; ++a) frame.target[a] = box.min[a] + unit(random) * box.extent(a);
        Vec3d from{normal(random), normal(random), std::fabs(normal(random)) + 0.1};
        const double distance = box.diagonal() * std::pow(10.0, 2.3 * unit(random) - 2);
        frame.eye = frame.target + distance * normalised(from);
        if (unit(random) < 0.75)
            frame.angle = 45;
        else
            frame.height = distance;
        const Camera camera = view_of(frame, box.centre(), box, 1280, 720);
        if (const auto ray = PickRay::through(camera, 1280 * unit(random), 720 * unit(random))) rays.push_back(*ray);
    }
    return rays;
}

struct Best {
    double depth = std::numeric_limits<double>::infinity();
    NodeId node = no_node;
    std::uint32_t index = 0;
    auto order() const { return std::tie(depth, node, index); }
};

// The rays by coordinate, so that a loop over them is vectors.
struct Columns {
    std::vector<double> start[3], direction[3], pixel, growth;
    std::vector<std::uint8_t> near;

    explicit Columns(const std::vector<PickRay>& rays) : near(rays.size())
    {
        for (const PickRay& ray : rays) {
            for (std::size_t a = 0; a < 3; ++a) {
                start[a].push_back(ray.start[a]);
                direction[a].push_back(ray.direction[a]);
            }
            pixel.push_back(ray.pixel);
            growth.push_back(ray.pixel_growth);
        }
    }
    // Marks the rays that the point, relative to their centre, may be a hit of.
    PCM_CLONES void mark(const Vec3d& p, double limit, double tolerance, double largest)
    {
        for (std::size_t r = 0; r < near.size(); ++r) {
            const double x = p[0] - start[0][r], y = p[1] - start[1][r], z = p[2] - start[2][r];
            const double t = direction[0][r] * x + direction[1][r] * y + direction[2][r] * z;
            const double ax = x - t * direction[0][r], ay = y - t * direction[1][r], az = z - t * direction[2][r];
            const double size = pixel[r] + t * growth[r];
            const double wide = limit > tolerance * size ? limit : tolerance * size;
            const double reach = wide < largest * size ? wide : largest * size;
            near[r] = static_cast<std::uint8_t>(ax * ax + ay * ay + az * az <= reach * reach * (1 + 1e-9));
        }
    }
};

double limit_of(const TreeInfo& info, std::size_t level)
{
    return level == 0 ? std::numeric_limits<double>::infinity() : 4 * info.spacings[level - 1];
}

void look_at_chunk(const Tree& tree, const PointSizes& sizes, NodeId id, const std::vector<PickRay>& rays,
                   const PickOptions& options, Columns& columns, std::vector<Best>& best)
{
    const Node& node = tree.node(id);
    const Chunk chunk = tree.read_chunk(id, ColumnSet::whole(tree.info().schema));
    std::vector<PointShape> shapes;
    if (options.fitted) find_shapes(*chunk.positions, tree.info().grid.scale, points_of_segments(node), shapes);
    std::vector<float> radii;
    sizes.find_radii(id, chunk, radii, options.fitted ? &shapes : nullptr);
    std::uint32_t i = 0;
    for (std::size_t k = 0; k < node.level_points.size(); ++k) {
        const double limit = limit_of(tree.info(), node.first_level + k);
        for (const std::uint32_t end = i + node.level_points[k]; i < end; ++i) {
            const Vec3d p = tree.info().grid.to_source(chunk.positions->grid(i));
            const double radius = options.size_scale * std::min(static_cast<double>(radii[i]), limit);
            columns.mark(p - rays[0].centre, radius, options.tolerance_px, options.largest_px);
            for (std::size_t r = 0; r < rays.size(); ++r) {
                if (!columns.near[r]) continue;
                const Vec3d d = (p - rays[r].centre) - rays[r].start;
                const double t = dot(rays[r].direction, d);
                const Vec3d across = d - t * rays[r].direction;
                const double square = dot(across, across), size = rays[r].pixel_at(t);
                const double reach = std::min(std::max(radius, options.tolerance_px * size), options.largest_px * size);
                if (t < rays[r].begin || t > rays[r].end || std::sqrt(square) > reach) continue;
                const Best found{square > 0 ? t + square / (2 * reach) : t, id, i};
                if (found.order() < best[r].order()) best[r] = found;
            }
        }
    }
}

std::vector<Best> brute_force(const Tree& tree, const PointSizes& sizes, const std::vector<PickRay>& rays,
                              const PickOptions& options)
{
    std::vector<Best> best(rays.size());
    std::mutex mutex;
    for_each_index(
        tree.nodes().size(), thread_count(0),
        [&](std::size_t id) {
            if (tree.node(static_cast<NodeId>(id)).points == 0) return;
            Columns columns(rays);
            std::vector<Best> own(rays.size());
            look_at_chunk(tree, sizes, static_cast<NodeId>(id), rays, options, columns, own);
            const std::lock_guard lock(mutex);
            for (std::size_t r = 0; r < rays.size(); ++r)
                if (own[r].order() < best[r].order()) best[r] = own[r];
        },
        [](std::size_t) {});
    return best;
}

double share(std::vector<double> values, double part)
{
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

int run(const std::string& path, std::size_t count, std::uint64_t seed, std::size_t checked)
{
    const auto cloud = PointCloud::open(path);
    const auto opened = Clock::now();
    PointPicker picker(cloud->cache());
    std::printf("%s: %llu points, %zu nodes; picker made in %.2f ms\n", path.c_str(),
                static_cast<unsigned long long>(cloud->info().points), cloud->tree()->nodes().size(),
                1e3 * seconds_since(opened));
    const std::vector<PickRay> rays = random_rays(cloud->info().bounds(), count, seed);
    const PickOptions options;
    std::vector<double> times, chunks, points;
    std::vector<Best> found(rays.size());
    std::size_t hits = 0;
    for (std::size_t r = 0; r < rays.size(); ++r) {
        cloud->cache().clear();
        const auto start = Clock::now();
        const PickResult result = picker.exact(rays[r], options);
        times.push_back(1e3 * seconds_since(start));
        chunks.push_back(static_cast<double>(result.read));
        points.push_back(static_cast<double>(result.outcome.points_in));
        if (!result.hit) continue;
        ++hits;
        found[r] = {result.hit->depth, result.hit->node, result.hit->index};
    }
    std::printf("%zu rays, %zu hit a point\n", rays.size(), hits);
    std::printf("%-24s %10s %10s %10s %10s\n", "", "p50", "p95", "p99", "most");
    const auto row = [&](const char* name, const std::vector<double>& v) {
        std::printf("%-24s %10.2f %10.2f %10.2f %10.2f\n", name, share(v, 0.5), share(v, 0.95), share(v, 0.99),
                    share(v, 1));
    };
    row("ms", times);
    row("chunks read", chunks);
    row("points looked at", points);
    if (checked == 0 || rays.empty()) return 0;
    const std::vector<PickRay> looked(rays.begin(),
                                      rays.begin() + static_cast<std::ptrdiff_t>(std::min(checked, count)));
    const auto start = Clock::now();
    const std::vector<Best> expected = brute_force(*cloud->tree(), picker.sizes(), looked, options);
    std::size_t wrong = 0;
    for (std::size_t r = 0; r < looked.size(); ++r) wrong += found[r].order() != expected[r].order();
    std::printf("a look at every point took %.1f s; %zu of %zu picks differ from it\n", seconds_since(start), wrong,
                looked.size());
    return wrong == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Picks along random rays");
    std::string path;
    std::size_t rays = 10000, checked = 10000;
    std::uint64_t seed = 1;
    bool levels = false;
    app.add_option("tree", path, "Tree folder")->required();
    app.add_option("--rays", rays, "Number of rays (default 10000)");
    app.add_option("--seed", seed, "Seed of the rays (default 1)");
    app.add_option("--checked", checked, "How many of them are compared with a look at every point (default 10000)");
    app.add_flag("--levels", levels,
                 "Instead: picks among the points in memory, by the depth of their nodes, a line of JSON each");
    CLI11_PARSE(app, argc, argv);
    try {
        if (levels) {
            L2Options cache;
            cache.capacity_bytes = std::uint64_t(4) << 30;
            const auto cloud = PointCloud::open(path, cache);
            bench::print_levels(*cloud, random_rays(cloud->info().bounds(), rays, seed));
            return 0;
        }
        return run(path, rays, seed, checked);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_pick: %s\n", error.what());
        return 1;
    }
}
