#include "bench/fit/cgal_shapes.h"
#include "bench/fit/methods.h"

#include <utility>

namespace pcm::bench {
namespace {

using Item = std::pair<Kernel::Point_3, Kernel::Vector_3>;
using Items = std::vector<Item>;
using Traits = CGAL::Shape_detection::Efficient_RANSAC_traits<Kernel, Items, CGAL::First_of_pair_property_map<Item>,
                                                              CGAL::Second_of_pair_property_map<Item>>;
using Search = CGAL::Shape_detection::Efficient_RANSAC<Traits>;
using PlaneShape = CGAL::Shape_detection::Plane<Traits>;
using CylinderShape = CGAL::Shape_detection::Cylinder<Traits>;
using SphereShape = CGAL::Shape_detection::Sphere<Traits>;
using ConeShape = CGAL::Shape_detection::Cone<Traits>;

}  // namespace

MethodResult fit_by_cgal(const FitScene& scene, const ShapeFitOptions& options)
{
    const FitPoints& points = scene.points;
    Items items;
    items.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        items.emplace_back(Kernel::Point_3(points.x[i], points.y[i], points.z[i]),
                           Kernel::Vector_3(points.nx[i], points.ny[i], points.nz[i]));
    Search search;
    search.set_input(items);
    switch (options.kind) {
        case ShapeKind::plane:
            search.add_shape_factory<PlaneShape>();
            break;
        case ShapeKind::cylinder:
            search.add_shape_factory<CylinderShape>();
            break;
        case ShapeKind::sphere:
            search.add_shape_factory<SphereShape>();
            break;
        default:
            search.add_shape_factory<ConeShape>();
    }
    Search::Parameters parameters;
    parameters.probability = 1 - options.probability;  // probability of missing the largest shape
    parameters.min_points = std::max<std::size_t>(10, points.size() / 20);
    parameters.epsilon = options.threshold;
    parameters.cluster_epsilon = 1e3 * (1 + scene.options.size + scene.options.radius);  // one cluster
    parameters.normal_threshold = 0.8;
    search.detect(parameters);
    MethodResult result;
    std::size_t most = 0;
    for (const auto& found : search.shapes()) {
        const auto shape = shape_of(*found, points.origin);
        if (!shape || found->indices_of_assigned_points().size() <= most) continue;
        most = found->indices_of_assigned_points().size();
        result.shape = shape;
    }
    return result;
}

}  // namespace pcm::bench
