#include "pcm/detect/cloud_part.h"

#include <algorithm>

namespace pcm {
namespace {

bool intersect(const Box3i& a, const Box3i& b)
{
    for (std::size_t i = 0; i < 3; ++i)
        if (a.min[i] > b.max[i] || b.min[i] > a.max[i]) return false;
    return !a.empty() && !b.empty();
}

}  // namespace

CloudPart CloudPart::others() const
{
    CloudPart part = *this;
    part.is_others_ = !is_others_;
    return part;
}

CloudPart CloudPart::within(const Box3i& box) const
{
    CloudPart part;
    part.is_others_ = is_others_;
    for (const Box3i& one : boxes_)
        if (intersect(one, box)) part.boxes_.push_back(one);
    return part;
}

bool CloudPart::touches(const Box3i& box) const
{
    const auto holds = [&](const Box3i& one) { return one.contains(box.min) && one.contains(box.max); };
    if (is_others_) return std::none_of(boxes_.begin(), boxes_.end(), holds);
    return std::any_of(boxes_.begin(), boxes_.end(), [&](const Box3i& one) { return intersect(one, box); });
}

bool CloudPart::contains(const Vec3i& q) const
{
    const bool inside = std::any_of(boxes_.begin(), boxes_.end(), [&](const Box3i& one) { return one.contains(q); });
    return inside != is_others_;
}

}  // namespace pcm
