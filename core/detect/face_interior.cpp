#include "pcm/detect/face_interior.h"

#include "pcm/cloud/growing_box_tree.h"
#include "pcm/detect/tuning.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm {
namespace {

bool are_parallel(const Shape& a, const Shape& b)
{
    return traits_of(b.kind).is_flat() && std::fabs(dot(a.axis, b.axis)) > detect_tuning().faces.max_cosine;
}

}  // namespace

FaceInteriors::FaceInteriors(std::vector<MeetingSurface> surfaces)
    : surfaces_(std::move(surfaces)), meets_(surfaces_.size())
{
    GrowingBoxTree boxes;
    for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
        MeetingSurface& one = surfaces_[s];
        const double reach = detect_tuning().faces.reach * one.threshold;
        for (std::size_t a = 0; a < 3; ++a) one.box.min[a] -= reach, one.box.max[a] += reach;
        boxes.add(one.box, s);
    }
    for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
        if (!surfaces_[s].outline) continue;
        for (const std::uint32_t other : boxes.touching(surfaces_[s].box))
            if (other != s && !are_parallel(surfaces_[s].shape, surfaces_[other].shape)) meets_[s].push_back(other);
    }
}

std::optional<FaceInteriors::InBox> FaceInteriors::inside(std::size_t surface, const Box3d& box) const
{
    if (!surfaces_[surface].outline) return std::nullopt;
    InBox inside;
    inside.face_ = &surfaces_[surface];
    inside.border_ = detect_tuning().faces.border;
    inside.reach_ = detect_tuning().faces.reach;
    for (const std::uint32_t other : meets_[surface])
        if (surfaces_[other].box.intersects(box)) inside.others_.push_back(&surfaces_[other]);
    return inside;
}

bool FaceInteriors::InBox::has(const Vec3d& p) const
{
    const auto is_of = [&](const MeetingSurface* other) {
        const double reach = reach_ * other->threshold;
        return distance_to(other->shape, p) <= reach && other->box.contains(p) &&
               (!other->outline || other->outline->gap_to(p) <= reach);
    };
    return face_->outline->gap_to(p) <= -border_ * face_->threshold &&
           std::none_of(others_.begin(), others_.end(), is_of);
}

}  // namespace pcm
