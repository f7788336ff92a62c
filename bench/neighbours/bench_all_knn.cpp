// The k nearest neighbours of all points in memory: our search at each level of instructions compared with FLANN,
// nanoflann and PCL, on one thread. All take turns in one run; CPU seconds of the thread, index and queries; and the
// error of the distance to the k-th neighbour against all pairs in double.
#include "bench/neighbours/peers.h"
#include "pcm/cloud/morton.h"
#include "pcm/io/reader.h"
#include "pcm/knn/unit_search.h"
#include "pcm/system/cpu.h"
#include "pcm/system/error.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numeric>
#include <random>

namespace {

using namespace pcm;

struct Scene {
    std::array<std::vector<std::int32_t>, 3> steps;
    Vec3d scale{};
    std::size_t size() const { return steps[0].size(); }
};

// Steps of 1 mm in a cube as large as gives one point per litre.
Scene random_scene(std::size_t size)
{
    Scene scene;
    scene.scale = {0.001, 0.001, 0.001};
    const auto side = static_cast<std::int32_t>(100 * std::cbrt(static_cast<double>(size)));
    std::mt19937_64 random(1);
    std::uniform_int_distribution<std::int32_t> place(0, side);
    for (auto& axis : scene.steps) {
        axis.resize(size);
        for (auto& v : axis) v = place(random);
    }
    return scene;
}

Scene read_scene(const std::string& path)
{
    const auto reader = open_reader(path);
    if (!reader->info().grid) throw Error(ErrorCode::unsupported, path, "its positions lie on no grid", "use LAS");
    Scene scene;
    scene.scale = reader->info().grid->scale;
    PointBatch batch;
    while (reader->read(batch, default_batch_points))
        for (std::size_t axis = 0; axis < 3; ++axis)
            scene.steps[axis].insert(scene.steps[axis].end(), batch.grid_xyz[axis].begin(),
                                     batch.grid_xyz[axis].begin() + static_cast<std::ptrdiff_t>(batch.size));
    for (auto& axis : scene.steps) {
        const auto [low, high] = std::minmax_element(axis.begin(), axis.end());
        const std::int32_t middle = *low + (*high - *low) / 2;
        for (auto& v : axis) v -= middle;
    }
    return scene;
}

void put_in_order(Scene& scene, const std::string& order)
{
    std::vector<std::uint32_t> places(scene.size());
    std::iota(places.begin(), places.end(), 0u);
    if (order == "random") std::shuffle(places.begin(), places.end(), std::mt19937_64(2));
    if (order == "morton") {
        std::vector<Vec3d> points(scene.size());
        for (std::size_t i = 0; i < points.size(); ++i)
            for (std::size_t axis = 0; axis < 3; ++axis) points[i][axis] = scene.steps[axis][i] * scene.scale[axis];
        places = morton_order(points);
    }
    for (auto& axis : scene.steps) {
        std::vector<std::int32_t> moved(axis.size());
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = axis[places[i]];
        axis.swap(moved);
    }
}

std::vector<float> single_precision(const Scene& scene, const Vec3d& offset)
{
    std::vector<float> xyz(3 * scene.size());
    for (std::size_t i = 0; i < scene.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis)
            xyz[3 * i + axis] = static_cast<float>(scene.steps[axis][i] * scene.scale[axis] + offset[axis]);
    return xyz;
}

double exact_distance(const Scene& scene, std::size_t query, std::size_t k)
{
    std::vector<double> squares(scene.size());
    for (std::size_t i = 0; i < squares.size(); ++i) {
        double d[3];
        for (std::size_t axis = 0; axis < 3; ++axis)
            d[axis] = static_cast<double>(scene.steps[axis][i] - scene.steps[axis][query]) * scene.scale[axis];
        squares[i] = (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
    }
    std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(k), squares.end());
    return std::sqrt(squares[k]);  // the point itself is the first
}

bench::PeerRun run_ours(const Scene& scene, std::size_t k, const std::vector<std::uint32_t>& sampled)
{
    bench::PeerRun run;
    std::map<std::uint32_t, std::size_t> rows;
    for (std::size_t i = 0; i < sampled.size(); ++i) rows[sampled[i]] = i;
    run.sampled.resize(sampled.size());
    std::vector<bool> wanted(scene.size());
    for (const std::uint32_t s : sampled) wanted[s] = true;
    SearchPositions positions;
    positions.narrow = scene.steps;
    positions.scale = scene.scale;
    const double begin = bench::thread_seconds();
    const auto search = make_unit_search(std::move(positions));
    const double built = bench::thread_seconds();
    search->search(nullptr, {k, std::numeric_limits<double>::infinity()}, [&](const FoundNeighbours& found) {
        for (std::size_t i = 0; i < found.size; ++i) {
            const double square = found.squared[i * found.stride + found.counts[i] - 1];
            run.sum += square;
            if (wanted[found.points[i]]) run.sampled[rows[found.points[i]]] = std::sqrt(square);
        }
    });
    run.build = built - begin;
    run.query = bench::thread_seconds() - built;
    return run;
}

struct Times {
    std::vector<double> build, query, all;
    double worst = 0;  // relative error
};

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

struct Options {
    std::string scene, order = "random";
    std::size_t k = 16;
    int rounds = 3;
    bool map = false;
    std::vector<std::string> methods;
};

std::vector<bench::Peer> methods_of(const Scene& scene, const Options& options)
{
    std::vector<bench::Peer> methods;
    for (const SimdLevel level : simd_levels())
        methods.push_back({"pcm " + std::string(name_of(level)),
                           [&scene, level](const std::vector<float>&, std::size_t k, const auto& sampled) {
                               setenv("PCM_SIMD", std::string(name_of(level)).c_str(), 1);
                               return run_ours(scene, k, sampled);
                           }});
    for (auto& peer : bench::peers()) methods.push_back(peer);
    if (!options.methods.empty())
        methods.erase(std::remove_if(methods.begin(), methods.end(),
                                     [&](const bench::Peer& peer) {
                                         return std::find(options.methods.begin(), options.methods.end(), peer.name) ==
                                                options.methods.end();
                                     }),
                      methods.end());
    return methods;
}

void measure(const Options& options)
{
    const bool generated = options.scene.rfind("random:", 0) == 0;
    Scene scene = generated ? random_scene(static_cast<std::size_t>(std::stod(options.scene.substr(7))))
                            : read_scene(options.scene);
    put_in_order(scene, options.order);
    const std::vector<float> xyz = single_precision(scene, options.map ? Vec3d{5e5, 4.8e6, 100} : Vec3d{});
    std::vector<std::uint32_t> sampled;
    std::mt19937_64 random(3);
    while (sampled.size() < std::min<std::size_t>(200, scene.size())) {
        const auto point = static_cast<std::uint32_t>(random() % scene.size());
        if (std::find(sampled.begin(), sampled.end(), point) == sampled.end()) sampled.push_back(point);
    }
    const auto methods = methods_of(scene, options);
    std::vector<Times> times(methods.size());
    for (int round = 0; round < options.rounds; ++round)
        for (std::size_t m = 0; m < methods.size(); ++m) {
            const bench::PeerRun run = methods[m].run(xyz, options.k, sampled);
            times[m].build.push_back(run.build);
            times[m].query.push_back(run.query);
            times[m].all.push_back(run.build + run.query);
            if (round > 0) continue;
            for (std::size_t i = 0; i < sampled.size(); ++i) {
                const double exact = exact_distance(scene, sampled[i], options.k);
                times[m].worst = std::max(times[m].worst, std::fabs(run.sampled[i] - exact) / (exact > 0 ? exact : 1));
            }
        }
    double best_peer = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m < methods.size(); ++m)
        if (methods[m].name.rfind("pcm", 0) != 0) best_peer = std::min(best_peer, median(times[m].all));
    std::printf("%s, %zu points, %s order, k = %zu%s, %d rounds; CPU seconds, medians\n", options.scene.c_str(),
                scene.size(), options.order.c_str(), options.k, options.map ? ", at map coordinates" : "",
                options.rounds);
    std::printf("%-14s %9s %9s %9s %10s %12s %14s\n", "", "index", "queries", "all", "us/point", "best peer x",
                "largest error");
    for (std::size_t m = 0; m < methods.size(); ++m)
        std::printf("%-14s %9.3f %9.3f %9.3f %10.3f %12.2f %14.1e\n", methods[m].name.c_str(), median(times[m].build),
                    median(times[m].query), median(times[m].all),
                    1e6 * median(times[m].all) / static_cast<double>(scene.size()), best_peer / median(times[m].all),
                    times[m].worst);
}

}  // namespace

int main(int argc, char** argv)
{
    CLI::App app("Neighbours of all points in memory compared with other libraries");
    Options options;
    app.add_option("scene", options.scene, "A file of points on a grid (LAS), or random:N")->required();
    app.add_option("-k", options.k, "Neighbours")->capture_default_str();
    app.add_option("--order", options.order, "Order of the points: file, random or morton")
        ->check(CLI::IsMember({"file", "random", "morton"}))
        ->capture_default_str();
    app.add_option("--rounds", options.rounds, "Repetitions; medians are shown")->capture_default_str();
    app.add_flag("--map", options.map, "Coordinates of a map: 5e5, 4.8e6 is added");
    app.add_option("--only", options.methods, "Only these, by the names shown");
    CLI11_PARSE(app, argc, argv);
    try {
        measure(options);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "bench_all_knn: %s\n", e.what());
        return 1;
    }
}
