// Whether the order of a chunk's points in its VBO changes the time to draw them: as the tree stores them (level by
// level, each in Morton order), all in one Morton order, and that in batches of 128 points which are shuffled (Schütz
// et al., arXiv 2104.07526). Prints a table; see README.md.
#include "pcm/cloud/morton.h"
#include "pcm/gl/draw/splat_pass.h"
#include "pcm/gl/l1/l1_cache.h"
#include "pcm/offscreen/offscreen.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "pcm/view/point_sizes.h"
#include "pcm/view/vertex_discs.h"

#include <GL/glew.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace pcm;
using Clock = std::chrono::steady_clock;

constexpr const char* order_names[] = {"as stored", "Morton", "batches of 128"};
constexpr std::size_t orders = 3;

std::vector<std::uint32_t> order_of(const ChunkPositions& positions, const Vec3d& scale, std::size_t order)
{
    std::vector<std::uint32_t> list(positions.size());
    std::iota(list.begin(), list.end(), 0u);
    if (order == 0) return list;
    // In steps of the chunk's largest side over 2^21, as the grid's may differ from axis to axis.
    const auto place = [&](std::size_t i, std::size_t a) {
        return static_cast<double>(positions.relative(i, a)) * scale[a];
    };
    double most = 1e-300;
    for (std::size_t i = 0; i < list.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a) most = std::max(most, place(i, a));
    std::vector<std::uint64_t> code(list.size());
    for (std::size_t i = 0; i < list.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a)
            code[i] |= spread_bits(static_cast<std::uint64_t>(place(i, a) / most * 0x1fffff)) << a;
    std::sort(list.begin(), list.end(),
              [&](std::uint32_t a, std::uint32_t b) { return code[a] != code[b] ? code[a] < code[b] : a < b; });
    if (order == 1) return list;
    std::vector<std::size_t> batches((list.size() + 127) / 128);
    std::iota(batches.begin(), batches.end(), std::size_t(0));
    std::mt19937 random(1);
    std::shuffle(batches.begin(), batches.end(), random);
    std::vector<std::uint32_t> shuffled;
    for (const std::size_t batch : batches)
        for (std::size_t i = 128 * batch; i < std::min(list.size(), 128 * (batch + 1)); ++i)
            shuffled.push_back(list[i]);
    return shuffled;
}

ChunkPositions permuted(const ChunkPositions& from, const std::vector<std::uint32_t>& list)
{
    ChunkPositions to;
    to.origin = from.origin;
    to.wide = true;
    for (std::size_t a = 0; a < 3; ++a)
        for (const std::uint32_t i : list) to.wide_xyz[a].push_back(from.relative(i, a));
    return to;
}

// A cloud in video memory three times.
struct Cloud {
    std::shared_ptr<PointCloud> points;
    std::unique_ptr<L1Cache> l1;
    std::vector<L1Cache::Owner> owners;  // one an order
    std::vector<NodeId> nodes;
    std::uint64_t count = 0;
    VertexFormat format;

    Cloud(const std::string& path, std::uint64_t most, SplatMode mode) : points(PointCloud::open(path))
    {
        CloudStyle style;
        style.splats = mode;
        style.colour = ColourMode::uniform;
        format = format_of(usable_style(style, points->info().schema, nullptr));
        const NodeTable& all = points->cache().tree().nodes();
        std::vector<NodeId> by_depth(all.size());
        std::iota(by_depth.begin(), by_depth.end(), NodeId(0));
        std::stable_sort(by_depth.begin(), by_depth.end(),
                         [&](NodeId a, NodeId b) { return all[a].depth < all[b].depth; });
        for (const NodeId node : by_depth)
            if (all[node].points > 0 && count + all[node].points <= most) {
                nodes.push_back(node);
                count += all[node].points;
            }
        L1Options options;
        options.capacity_bytes = std::max<std::uint64_t>(
            orders * (count * format.stride() * 5 / 4 + nodes.size() * L1Cache::page_bytes), 64u << 20);
        l1 = std::make_unique<L1Cache>(options);
        const Schema& schema = points->info().schema;
        std::vector<std::string> names;
        if (format.radius) names.emplace_back(attribute_name::radius);
        if (format.normal) names.emplace_back(attribute_name::normal);
        for (std::size_t order = 0; order < orders; ++order) {
            owners.push_back(l1->add_owner());
            l1->begin_frame(owners.back());
        }
        const PointSizes sizes(points->cache().tree());
        for (const NodeId node : nodes) {
            ColumnSet columns = ColumnSet::named(schema, names);
            columns.sizes = format.radius;
            const auto chunk = points->cache().get(node, columns);
            std::vector<float> radii, normals;
            if (format.radius) sizes.find_radii(node, *chunk, radii);
            if (format.normal)
                make_normals(*chunk->attributes[*schema.find(attribute_name::normal)],
                             schema[*schema.find(attribute_name::normal)], normals);
            for (std::size_t order = 0; order < orders; ++order) {
                const auto list = order_of(*chunk->positions, points->info().grid.scale, order);
                std::vector<float> r, n;
                for (const std::uint32_t i : list) {
                    if (format.radius) r.push_back(radii[i]);
                    if (format.normal) n.insert(n.end(), normals.begin() + 3 * i, normals.begin() + 3 * i + 3);
                }
                if (!l1->upload(owners[order], node,
                                make_vertices(permuted(*chunk->positions, list), points->info().grid.scale, format,
                                              {nullptr, r.data(), n.data()})))
                    throw Error(ErrorCode::unsupported, path, "the device has no room for the points",
                                "choose fewer with --points");
            }
        }
    }
};

// The eye looks along (0.6, 0.5, -0.45) at the middle of the cloud, `distance` of its diagonal away.
Camera view_of(const TreeInfo& info, double distance, int width, int height)
{
    const Box3d box = info.bounds();
    const double diagonal = std::max(box.diagonal(), 1e-9);
    Camera view;
    view.width = width;
    view.height = height;
    view.origin = box.centre();
    const Vec3d d = normalised({0.6, 0.5, -0.45});
    const double flat = std::hypot(d[0], d[1]);
    const Vec3d right{d[1] / flat, -d[0] / flat, 0};
    const Vec3d up = cross(right, d);
    view.modelview = {
        right[0], up[0], -d[0], 0, right[1], up[1], -d[1], 0, right[2], up[2], -d[2], 0, 0, 0, -distance * diagonal, 1};
    const double near = 1e-4 * diagonal;
    const double far = 3 * diagonal;
    const double f = 1.7;
    view.projection = {f * height / width,
                       0,
                       0,
                       0,
                       0,
                       f,
                       0,
                       0,
                       0,
                       0,
                       -(far + near) / (far - near),
                       -1,
                       0,
                       0,
                       -2 * far * near / (far - near),
                       0};
    return view;
}

double median(std::vector<double>& v)
{
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
}

// Medians of the times and of the ratios to the order as stored, milliseconds.
struct Timing {
    double ms[orders], ratio[orders];
};

Timing time_orders(const Offscreen& offscreen, SplatPass& pass, const Cloud& cloud, const Camera& view,
                   const CloudStyle& style, unsigned rounds)
{
    std::vector<double> times[orders], ratios[orders];
    for (unsigned round = 0; round <= rounds; ++round) {
        double took[orders];
        for (std::size_t k = 0; k < orders; ++k) {
            const std::size_t order = (k + round) % orders;
            offscreen.make_current();
            offscreen.clear();
            glFinish();
            const auto start = Clock::now();
            pass.begin(view, cloud.points->info(), style, false, 1);
            for (const NodeId node : cloud.nodes) pass.draw(*cloud.l1->find(cloud.owners[order], node), {});
            pass.end();
            glFinish();
            took[order] = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
        }
        if (round == 0) continue;  // compilation
        for (std::size_t k = 0; k < orders; ++k) {
            times[k].push_back(took[k]);
            ratios[k].push_back(took[k] / took[0]);
        }
    }
    Timing timing{};
    for (std::size_t k = 0; k < orders; ++k) {
        timing.ms[k] = median(times[k]);
        timing.ratio[k] = median(ratios[k]);
    }
    return timing;
}

int run(const std::string& path, std::uint64_t most, int width, int height, unsigned rounds)
{
    const Offscreen offscreen(width, height);
    std::printf(
        "%s\n%d x %d, medians of %u rounds in which the orders take turns; ms a frame, and the median ratio to the "
        "order as stored in the same round\n\n",
        offscreen.renderer().c_str(), width, height, rounds);
    std::printf(
        "| splats | px | distance | points | %s | %s | ratio | %s | ratio |\n|---|---|---|---|---|---|---|---|---|\n",
        order_names[0], order_names[1], order_names[2]);
    for (const SplatMode mode : {SplatMode::constant, SplatMode::perspective}) {
        const Cloud cloud(path, most, mode);
        if (mode != SplatMode::constant && !cloud.format.normal) {
            std::printf("(%s: the tree has no normals)\n", name_of(mode));
            break;
        }
        SplatPass pass;
        CloudStyle style;
        style.splats = mode;
        style.colour = ColourMode::uniform;
        for (const double distance : {0.9, 0.4, 0.12}) {
            for (const float size : {1.0f, 2.0f, 5.0f}) {
                if (mode != SplatMode::constant && size != 1) continue;
                style.point_size_px = size;
                const Camera view = view_of(cloud.points->info(), distance, width, height);
                const Timing timing = time_orders(offscreen, pass, cloud, view, style, rounds);
                std::printf("| %s | %g | %g | %llu | %.1f | %.1f | %.3f | %.1f | %.3f |\n", name_of(mode),
                            mode == SplatMode::constant ? static_cast<double>(size) : 0.0, distance,
                            static_cast<unsigned long long>(cloud.count), timing.ms[0], timing.ms[1], timing.ratio[1],
                            timing.ms[2], timing.ratio[2]);
                std::fflush(stdout);
            }
        }
        pass.release();
        cloud.l1->release();
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Times the order of points in video memory");
    std::string tree;
    std::uint64_t points = 3'000'000;
    int width = 1280, height = 720;
    unsigned rounds = 15;
    app.add_option("tree", tree, "Tree folder")->required();
    app.add_option("-n,--points", points, "Most points to draw, the coarsest chunks first")->capture_default_str();
    app.add_option("--width", width)->capture_default_str()->check(CLI::Range(16, 8192));
    app.add_option("--height", height)->capture_default_str()->check(CLI::Range(16, 8192));
    app.add_option("--rounds", rounds)->capture_default_str()->check(CLI::Range(1u, 1000u));
    CLI11_PARSE(app, argc, argv);
    try {
        return run(tree, points, width, height, rounds);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
