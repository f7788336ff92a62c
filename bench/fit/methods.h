// What bench_fit compares, by name.
#pragma once

#include "bench/fit/fit_scene.h"
#include "pcm/fit/shape_fit.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcm::bench {

struct MethodResult {
    std::optional<Shape> shape;
    std::string verdict, issue;  // ours only
    double radius_sigma = 0;     // claimed standard deviation of the radius; ours only
    std::uint64_t samples = 0;
    double threshold = 0;       // m; of ours
    std::uint64_t inliers = 0;  // ours only
};

struct Method {
    std::string name;
    std::function<MethodResult(const FitScene&, const ShapeFitOptions&)> run;
};

// "own-msac", "pcl-msac", "pcl-msac-raw" (without PCL's least squares at the end), "pcl-rransac-default" (with PCL's
// own pretest), "cgal": those that are here.
std::vector<Method> fit_methods();

// CGAL's efficient RANSAC, the shape with the maximum number of points, where CGAL is installed.
MethodResult fit_by_cgal(const FitScene& scene, const ShapeFitOptions& options);

}  // namespace pcm::bench
