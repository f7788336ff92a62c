// CGAL's efficient RANSAC on a sample of a generated site, judged as bench_detect judges ours. See ../README.md.
#include "bench/detect/truth.h"
#include "bench/fit/cgal_shapes.h"
#include "pcm/fit/shape_fit.h"
#include "pcm/system/peak_memory.h"
#include "pcm/tree/tree.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::bench;
using Item = std::tuple<Kernel::Point_3, Kernel::Vector_3, std::uint32_t>;  // detect() changes their order
using Items = std::vector<Item>;
using Traits = CGAL::Shape_detection::Efficient_RANSAC_traits<Kernel, Items, CGAL::Nth_of_tuple_property_map<0, Item>,
                                                              CGAL::Nth_of_tuple_property_map<1, Item>>;
using Search = CGAL::Shape_detection::Efficient_RANSAC<Traits>;
using PlaneShape = CGAL::Shape_detection::Plane<Traits>;
using CylinderShape = CGAL::Shape_detection::Cylinder<Traits>;
using SphereShape = CGAL::Shape_detection::Sphere<Traits>;

// Every n-th point, with its true primitive.
FitPoints sample(const Tree& tree, std::uint64_t every, std::vector<std::uint32_t>& ids)
{
    FitPoints points;
    points.origin = tree.info().bounds().centre();
    const std::size_t source = *tree.info().schema.find("point_source_id");
    std::uint64_t number = 0;
    for (NodeId node = 0; node < tree.nodes().size(); ++node) {
        ColumnSet columns = ColumnSet::only_positions();
        columns.attributes.set(source);
        const Chunk chunk = tree.read_chunk(node, columns);
        for (std::size_t i = 0; i < chunk.points; ++i) {
            if (number++ % every != 0) continue;
            points.add(tree.info().grid.to_source(chunk.positions->grid(i)));
            ids.push_back(static_cast<std::uint32_t>(chunk.attributes[source]->value(i, 0)));
        }
    }
    return points;
}

int run(const std::string& path, std::uint64_t wanted, double threshold, bool list)
{
    const auto tree = Tree::open(path);
    std::vector<True> truth = read_truth(std::filesystem::path(tree->folder()).replace_extension(".truth.json"));
    const std::uint64_t every = std::max<std::uint64_t>(1, tree->info().points / wanted);
    std::vector<std::uint32_t> ids;
    FitPoints points = sample(*tree, every, ids);
    for (True& one : truth) one.points = 0;
    for (const std::uint32_t id : ids) ++truth[id].points;
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    estimate_normals(points, 16);
    const double normals = seconds();
    Items items;
    for (std::size_t i = 0; i < points.size(); ++i)
        items.emplace_back(Kernel::Point_3(points.x[i], points.y[i], points.z[i]),
                           Kernel::Vector_3(points.nx[i], points.ny[i], points.nz[i]), ids[i]);
    Search search;
    search.set_input(items);
    search.add_shape_factory<PlaneShape>();
    search.add_shape_factory<CylinderShape>();
    search.add_shape_factory<SphereShape>();
    Search::Parameters parameters;
    parameters.probability = 0.01;
    parameters.min_points = 500;
    parameters.epsilon = threshold;
    parameters.cluster_epsilon = 0.25;
    parameters.normal_threshold = 0.94;  // 20 degrees
    search.detect(parameters);
    std::vector<Primitive> found;
    Pairs pairs;
    for (const auto& shape : search.shapes()) {
        const auto ours = shape_of(*shape, points.origin);
        if (!ours) continue;
        Primitive primitive;
        primitive.label = static_cast<std::uint32_t>(found.size() + 1);
        primitive.fit.shape = *ours;
        primitive.fit.verdict = FitVerdict::good;
        primitive.points = shape->indices_of_assigned_points().size();
        for (const std::size_t i : shape->indices_of_assigned_points())
            ++pairs[{primitive.label, std::get<2>(items[i])}];
        found.push_back(primitive);
    }
    Score score = compare(truth, found, pairs, 500, list);
    print(score);
    std::printf("CGAL: %zu of %llu points, threshold %.2f mm, %.1f s, of which normals %.1f s, peak memory %.0f MB\n",
                points.size(), static_cast<unsigned long long>(tree->info().points), threshold * 1e3, seconds(),
                normals, static_cast<double>(peak_memory_bytes()) / 1e6);
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc < 4) {
        std::fprintf(stderr, "usage: bench_detect_cgal TREE POINTS THRESHOLD [list]\n");
        return 2;
    }
    return run(argv[1], std::strtoull(argv[2], nullptr, 10), std::strtod(argv[3], nullptr), argc > 4);
}
