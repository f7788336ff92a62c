// The shapes that CGAL's efficient RANSAC found, as ours.
#pragma once

#define CGAL_DISABLE_GMP 1
#define CGAL_DISABLE_MPFR 1
#include "pcm/shapes/shape.h"

#include <CGAL/Shape_detection/Efficient_RANSAC.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <optional>

namespace pcm::bench {

using Kernel = CGAL::Simple_cartesian<double>;

inline Vec3d of(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }
inline Vec3d of(const Kernel::Vector_3& v) { return {v.x(), v.y(), v.z()}; }

// `Traits` are those of the search, in coordinates relative to `origin`. Nothing for a kind that we do not have.
template <class Traits>
std::optional<Shape> shape_of(const CGAL::Shape_detection::Shape_base<Traits>& found, const Vec3d& origin)
{
    namespace cgal = CGAL::Shape_detection;
    Shape shape;
    if (const auto* plane = dynamic_cast<const cgal::Plane<Traits>*>(&found)) {
        const Kernel::Plane_3 p = static_cast<Kernel::Plane_3>(*plane);
        shape.axis = normalised(of(p.orthogonal_vector()));
        shape.point = origin + of(p.point());
    } else if (const auto* cylinder = dynamic_cast<const cgal::Cylinder<Traits>*>(&found)) {
        shape.kind = ShapeKind::cylinder;
        shape.axis = normalised(of(cylinder->axis().to_vector()));
        shape.point = origin + of(cylinder->axis().point());
        shape.radius = cylinder->radius();
    } else if (const auto* sphere = dynamic_cast<const cgal::Sphere<Traits>*>(&found)) {
        shape.kind = ShapeKind::sphere;
        shape.point = origin + of(sphere->center());
        shape.radius = sphere->radius();
    } else if (const auto* cone = dynamic_cast<const cgal::Cone<Traits>*>(&found)) {
        shape.kind = ShapeKind::cone;
        shape.axis = normalised(of(cone->axis()));
        shape.point = origin + of(cone->apex());
        shape.second = cone->angle();
    } else {
        return {};
    }
    return shape;
}

}  // namespace pcm::bench
