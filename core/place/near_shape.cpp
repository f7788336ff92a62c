#include "pcm/place/near_shape.h"

#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>

namespace pcm {
namespace {

constexpr int most_halvings = 7;

// Half of the maximum change of the distance from the surface within the box.
double half_change(const Shape& shape, const Box3d& box)
{
    if (!traits_of(shape.kind).is_flat()) return box.diagonal() / 2;
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) sum += std::fabs(shape.axis[a]) * box.extent(a) / 2;
    return sum;
}

}  // namespace

NearShape::NearShape(const Shape& shape, double threshold, double normal_angle, const Schema& schema)
    : shape_(shape), threshold_(threshold), normals_(schema)
{
    check(shape);
    if (!(threshold > 0) || !std::isfinite(threshold))
        throw Error(ErrorCode::invalid_argument, {},
                    "the largest distance of a point from the " + std::string(traits_of(shape.kind).name) + " is " +
                        exact(threshold) + "; it is a positive number of source units");
    if (!(normal_angle > 0))
        throw Error(ErrorCode::invalid_argument, {},
                    "the largest angle between normals is " + exact(normal_angle) +
                        " radians; it is positive, and pi / 2 or more where normals are not compared");
    if (normals_.exists() && normal_angle < pi / 2) least_cosine_ = std::cos(normal_angle);
}

ColumnSet NearShape::columns() const
{
    ColumnSet columns;
    if (least_cosine_) columns.attributes.set(normals_.place());
    return columns;
}

void NearShape::narrow(const Chunk& chunk, const std::vector<Vec3d>& positions, std::vector<std::uint32_t>& some) const
{
    const Column* const normals = least_cosine_ ? chunk.attributes[normals_.place()].get() : nullptr;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < some.size(); ++k) {
        if (!holds(positions[k])) continue;
        if (normals) {
            const Vec3d n = normals_.at(*normals, some[k]);
            if (n != Vec3d{} && !(std::fabs(dot(n, normal_at(shape_, positions[k]))) >= *least_cosine_)) continue;
        }
        some[kept++] = some[k];
    }
    some.resize(kept);
}

// Maximum rounding error of distances in the box, and of the box's own numbers.
double NearShape::rounding_at(const Box3d& box) const
{
    double sum = std::max(largest_magnitude(box.min), largest_magnitude(box.max)) + largest_magnitude(shape_.point);
    for (const ShapeSize& size : traits_of(shape_.kind).sizes)
        if (size.unit == SizeUnit::length) sum += shape_.*size.value;
    return 1e-14 * sum;
}

BoxRelation NearShape::relation_by_distance(const Box3d& box, int halvings) const
{
    const double distance = distance_to(shape_, box.centre()), half = half_change(shape_, box) + rounding_at(box);
    if (distance > threshold_ + half) return BoxRelation::outside;
    if (distance + half <= threshold_) return least_cosine_ ? BoxRelation::crosses : BoxRelation::inside;
    if (halvings == 0 || traits_of(shape_.kind).is_flat()) return BoxRelation::crosses;
    std::size_t widest = 0;
    for (std::size_t a = 1; a < 3; ++a)
        if (box.extent(a) > box.extent(widest)) widest = a;
    Box3d lower = box, upper = box;
    lower.max[widest] = upper.min[widest] = box.centre()[widest];
    const BoxRelation first = relation_by_distance(lower, halvings - 1);
    if (first == BoxRelation::crosses) return first;
    return relation_by_distance(upper, halvings - 1) == first ? first : BoxRelation::crosses;
}

BoxRelation NearShape::relation(const Box3d& box) const
{
    return box.empty() ? BoxRelation::outside : relation_by_distance(box, most_halvings);
}

}  // namespace pcm
