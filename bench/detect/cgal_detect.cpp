// CGAL's efficient RANSAC on a sample of a generated site, compared as bench_detect compares ours. See ../README.md.
#include "bench/detect/sample.h"
#include "bench/fit/cgal_shapes.h"
#include "pcm/system/peak_memory.h"
#include "pcm/tree/tree.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <tuple>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::bench;
using Item = std::tuple<Kernel::Point_3, Kernel::Vector_3, std::size_t>;  // detect() changes their order
using Items = std::vector<Item>;
using Traits = CGAL::Shape_detection::Efficient_RANSAC_traits<Kernel, Items, CGAL::Nth_of_tuple_property_map<0, Item>,
                                                              CGAL::Nth_of_tuple_property_map<1, Item>>;
using Search = CGAL::Shape_detection::Efficient_RANSAC<Traits>;
using PlaneShape = CGAL::Shape_detection::Plane<Traits>;
using CylinderShape = CGAL::Shape_detection::Cylinder<Traits>;
using SphereShape = CGAL::Shape_detection::Sphere<Traits>;

int run(const std::string& path, const std::string& truth, double threshold, bool list)
{
    const auto tree = Tree::open(path);
    const PeerSample sample = read_sample(*tree);
    const FitPoints& points = sample.points;
    const auto start = std::chrono::steady_clock::now();
    Items items;
    for (std::size_t i = 0; i < points.size(); ++i)
        items.emplace_back(Kernel::Point_3(points.x[i], points.y[i], points.z[i]),
                           Kernel::Vector_3(points.nx[i], points.ny[i], points.nz[i]), i);
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
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    PeerResult result(sample);
    for (const auto& shape : search.shapes()) {
        std::vector<std::size_t> indices;
        for (const std::size_t i : shape->indices_of_assigned_points()) indices.push_back(std::get<2>(items[i]));
        if (const auto ours = shape_of(*shape, {})) result.add(*ours, indices);
    }
    result.print(truth, list);
    std::printf("CGAL: %zu points, threshold %.2f mm, %.1f s and %.1f s for normals, peak memory %.0f MB\n",
                points.size(), threshold * 1e3, seconds, sample.normals,
                static_cast<double>(peak_memory_bytes()) / 1e6);
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc < 4) {
        std::fprintf(stderr, "usage: bench_detect_cgal TREE TRUTH THRESHOLD [list]\n");
        return 2;
    }
    return run(argv[1], argv[2], std::strtod(argv[3], nullptr), argc > 4);
}
