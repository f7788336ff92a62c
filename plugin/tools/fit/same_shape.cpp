#include "plugin/tools/fit/same_shape.h"

#include "plugin/scene/drawn_primitives.h"

#include <algorithm>
#include <vector>

namespace pcm::host {

namespace {

constexpr double most_of = 0.8;
constexpr double overlap = 0.6;  // share of the larger extent, along each axis

std::vector<Vec3d> outline_of(const Primitive& primitive)
{
    std::vector<Vec3d> places;
    for (const Annotation& line : drawn_primitive(primitive, std::nullopt, {}))
        places.insert(places.end(), line.line.begin(), line.line.end());
    return places;
}

bool lies_on(const std::vector<Vec3d>& outline, const Shape& shape, double threshold)
{
    const auto near = [&](const Vec3d& p) { return distance_to(shape, p) <= threshold; };
    const auto count = std::count_if(outline.begin(), outline.end(), near);
    return !outline.empty() && static_cast<double>(count) >= most_of * static_cast<double>(outline.size());
}

bool overlaps(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b, double threshold)
{
    Box3d first, second;
    for (const Vec3d& p : a) first.extend(p);
    for (const Vec3d& p : b) second.extend(p);
    for (std::size_t k = 0; k < 3; ++k) {
        const double low = std::max(first.min[k], second.min[k]), high = std::min(first.max[k], second.max[k]);
        const double larger = std::max(first.extent(k), second.extent(k));
        if (high - low + 2 * threshold < overlap * (larger + 2 * threshold)) return false;
    }
    return true;
}

}  // namespace

std::optional<std::size_t> same_shape(const PrimitiveList& list, const Primitive& primitive)
{
    const std::vector<Vec3d> outline = outline_of(primitive);
    for (std::size_t i = 0; i < list.size(); ++i) {
        const Primitive& other = list[i];
        if (other.cloud != primitive.cloud || other.fit.shape.kind != primitive.fit.shape.kind) continue;
        const double threshold = std::max(other.fit.threshold, primitive.fit.threshold);
        const std::vector<Vec3d> others = outline_of(other);
        if (overlaps(outline, others, threshold) && lies_on(outline, other.fit.shape, threshold) &&
            lies_on(others, primitive.fit.shape, threshold))
            return i;
    }
    return std::nullopt;
}

}  // namespace pcm::host
