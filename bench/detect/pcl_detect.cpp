// PCL's SACSegmentation in a loop on a sample of a generated site, compared as bench_detect compares ours: of the
// planes, cylinders and spheres that it finds among all points that are left, the one with the most is taken out, until
// none has 500 or the time is over. See ../README.md.
#define PCL_NO_PRECOMPILE
#include "bench/detect/sample.h"
#include "pcm/system/peak_memory.h"

#include <pcl/point_types.h>
#include <pcl/segmentation/sac_segmentation.h>
#include <pcl/segmentation/impl/sac_segmentation.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace pcm;
using namespace pcm::bench;
using Search = pcl::SACSegmentationFromNormals<pcl::PointXYZ, pcl::Normal>;

constexpr std::size_t least_points = 500;

Shape shape_of(int model, const pcl::ModelCoefficients& c)
{
    Shape shape;
    const auto place = [&](std::size_t i) { return Vec3d{c.values[i], c.values[i + 1], c.values[i + 2]}; };
    if (model == pcl::SACMODEL_NORMAL_PLANE) {
        shape.axis = normalised(place(0));
        shape.point = (-c.values[3] / length(place(0))) * shape.axis;
    } else if (model == pcl::SACMODEL_CYLINDER) {
        shape.kind = ShapeKind::cylinder;
        shape.point = place(0);
        shape.axis = normalised(place(3));
        shape.radius = c.values[6];
    } else {
        shape.kind = ShapeKind::sphere;
        shape.point = place(0);
        shape.radius = c.values[3];
    }
    return shape;
}

struct Found {
    Shape shape;
    std::vector<int> points;
};

// The shape with most of the points that are left.
Found largest(const pcl::PointCloud<pcl::PointXYZ>::Ptr& cloud, const pcl::PointCloud<pcl::Normal>::Ptr& normals,
              const pcl::IndicesPtr& left, double threshold, int iterations)
{
    Found best;
    for (const int model : {pcl::SACMODEL_NORMAL_PLANE, pcl::SACMODEL_CYLINDER, pcl::SACMODEL_NORMAL_SPHERE}) {
        Search search;
        search.setModelType(model);
        search.setMethodType(pcl::SAC_RANSAC);
        search.setNormalDistanceWeight(0.02);
        search.setDistanceThreshold(threshold);
        search.setMaxIterations(iterations);
        search.setRadiusLimits(0.02, 10);
        search.setOptimizeCoefficients(true);
        search.setInputCloud(cloud);
        search.setInputNormals(normals);
        search.setIndices(left);
        pcl::PointIndices inliers;
        pcl::ModelCoefficients coefficients;
        search.segment(inliers, coefficients);
        if (inliers.indices.size() <= best.points.size()) continue;
        best.shape = shape_of(model, coefficients);
        best.points.assign(inliers.indices.begin(), inliers.indices.end());
    }
    return best;
}

int run(const std::string& path, const std::string& truth, double threshold, double most_seconds, int iterations,
        bool list)
{
    const PeerSample sample = read_sample(*Tree::open(path));
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const FitPoints& points = sample.points;
    const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
    const pcl::PointCloud<pcl::Normal>::Ptr normals(new pcl::PointCloud<pcl::Normal>);
    pcl::IndicesPtr left(new pcl::Indices);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto f = [](double value) { return static_cast<float>(value); };
        cloud->push_back({f(points.x[i]), f(points.y[i]), f(points.z[i])});
        normals->push_back({f(points.nx[i]), f(points.ny[i]), f(points.nz[i])});
        left->push_back(static_cast<int>(i));
    }
    PeerResult result(sample);
    std::size_t rounds = 0;
    bool ended = false;
    while (!ended && seconds() < most_seconds) {
        const Found found = largest(cloud, normals, left, threshold, iterations);
        ended = found.points.size() < least_points;
        if (ended) break;
        ++rounds;
        result.add(found.shape, {found.points.begin(), found.points.end()});
        std::vector<bool> taken(points.size(), false);
        for (const int i : found.points) taken[static_cast<std::size_t>(i)] = true;
        const pcl::IndicesPtr rest(new pcl::Indices);
        for (const int i : *left)
            if (!taken[static_cast<std::size_t>(i)]) rest->push_back(i);
        left = rest;
    }
    const double spent = seconds();
    result.print(truth, list);
    std::printf(
        "PCL: %zu points, threshold %.2f mm, %d iterations, %zu rounds (%s), %.1f s and %.1f s for normals, peak "
        "memory %.0f MB\n",
        points.size(), threshold * 1e3, iterations, rounds, ended ? "all" : "until the time was over", spent,
        sample.normals, static_cast<double>(peak_memory_bytes()) / 1e6);
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc < 6) {
        std::fprintf(stderr, "usage: bench_detect_pcl TREE TRUTH THRESHOLD SECONDS ITERATIONS [list]\n");
        return 2;
    }
    return run(argv[1], argv[2], std::strtod(argv[3], nullptr), std::strtod(argv[4], nullptr), std::atoi(argv[5]),
               argc > 6);
}
