#include "bench/fit/methods.h"

#include "pcm/fit/pcl_fit.h"

namespace pcm::bench {
namespace {

MethodResult by_own(const FitScene& scene, const ShapeFitOptions& options)
{
    const ShapeFit fit = fit_shape(scene.points, options);
    MethodResult result;
    if (fit.has_shape()) result.shape = fit.shape;
    result.verdict = name_of(fit.verdict);
    result.issue = name_of(fit.issue);
    result.radius_sigma = options.kind == ShapeKind::cone ? fit.errors.second : fit.errors.radius;
    result.samples = fit.iterations;
    result.threshold = fit.threshold;
    result.inliers = fit.inliers;
    return result;
}

MethodResult by_pcl(const FitScene& scene, const ShapeFitOptions& options, const PclOptions& pcl)
{
    const PclShape found = pcl_shape(scene.points, options, pcl);
    MethodResult result;
    if (found.found) result.shape = found.shape;
    result.samples = found.samples;
    return result;
}

}  // namespace

std::vector<Method> fit_methods()
{
    std::vector<Method> methods;
    for (const EstimatorTraits& row : estimators())
        methods.push_back({std::string("own-") + row.name, [&row](const FitScene& scene, ShapeFitOptions options) {
                               options.estimator = row.estimator;
                               return by_own(scene, options);
                           }});
    for (const EstimatorTraits& row : estimators()) {
        if (!why_no_pcl().empty()) break;
        const auto add = [&](const std::string& suffix, const auto& change) {
            methods.push_back({std::string("pcl-") + row.name + suffix,
                               [&row, change](const FitScene& scene, ShapeFitOptions options) {
                                   options.estimator = row.estimator;
                                   PclOptions pcl;
                                   change(pcl, scene);
                                   return by_pcl(scene, options, pcl);
                               }});
        };
        add("", [](PclOptions&, const FitScene&) {});
        add("-raw", [](PclOptions& pcl, const FitScene&) { pcl.optimise = false; });
        if (row.estimator == Estimator::rransac || row.estimator == Estimator::rmsac)
            add("-default", [](PclOptions& pcl, const FitScene& scene) { pcl.pretest = scene.points.size() / 10; });
    }
#ifdef PCM_BENCH_CGAL
    methods.push_back({"cgal", fit_by_cgal});
#endif
    return methods;
}

}  // namespace pcm::bench
