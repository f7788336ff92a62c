#include "pcm/gl/draw/splat_sieve.h"

#include "pcm/cloud/vector.h"
#include "pcm/gl/tuning.h"
#include "pcm/view/point_shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcm {
namespace {

constexpr double view_border = 2;  // pixels around the view that count as in it: half the smallest splat, and rounding

Box3d grown(Box3d box, double by)
{
    for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] -= by;
        box.max[a] += by;
    }
    return box;
}

}  // namespace

SplatSieve::SplatSieve(const SplatCamera& camera, const CloudStyle& style, double largest_point, int guard)
    : camera_(camera), style_(style), largest_point_(largest_point), guard_(guard)
{
    Camera wide = camera.view;
    wide.origin = {0, 0, 0};
    for (std::size_t c = 0; c < 4; ++c) {
        wide.projection[4 * c] *= wide.width / (wide.width + 2 * view_border);
        wide.projection[4 * c + 1] *= wide.height / (wide.height + 2 * view_border);
    }
    seen_ = Frustum::of(wide);
}

void SplatSieve::sort(const VertexEntry& entry, const Box3d& whole, SplatShape shape, const ChunkLook& look,
                      std::vector<SplatPart>* parts, const ViewClips* clips)
{
    const SplatTuning& tuned = gl_tuning().splats;
    as_points_.clear();
    as_quads_.clear();
    clipped_ = 0;
    const Box3d reached = grown(whole, reach(shape, entry.largest_radius, look));
    if (!seen_ || !seen_->intersects(reached)) return;
    const bool all = seen_->contains(reached);
    const bool quads = needs_quads(shape, whole, entry.largest_radius, look);
    if (all && !quads && !clips && (!parts || depth_range(whole) < tuned.by_groups)) {
        as_points_.push_back({0, entry.points});
        if (parts)
            parts->push_back(depth_range(whole) < tuned.one_place ? part_of(whole, entry.points)
                                                                  : part_in_view(whole, entry.points));
        return;
    }
    for (std::size_t g = 0; g < entry.groups.size(); ++g) {
        const VertexGroup& group = entry.groups[g];
        const auto start = static_cast<std::uint32_t>(g * VertexGroup::points);
        const std::uint32_t points = std::min<std::uint32_t>(VertexGroup::points, entry.points - start);
        Box3d box;
        for (std::size_t a = 0; a < 3; ++a) {
            box.min[a] = whole.min[a] + static_cast<double>(group.low[a]);
            box.max[a] = whole.min[a] + static_cast<double>(group.high[a]);
        }
        if (clips &&
            clips->relation({box.min + camera_.view.origin, box.max + camera_.view.origin}) == BoxRelation::outside) {
            clipped_ += points;
            continue;
        }
        if (!all && !seen_->intersects(grown(box, reach(shape, group.largest_radius, look)))) continue;
        add_run(quads && needs_quads(shape, box, group.largest_radius, look) ? as_quads_ : as_points_, start, points);
        if (parts)
            parts->push_back(depth_range(box) < tuned.one_place && (all || seen_->contains(box))
                                 ? part_of(box, points)
                                 : part_in_view(box, points));
    }
}

// Whether splats in a box may be larger than the driver's points. SplatShape::pixels never is.
bool SplatSieve::needs_quads(SplatShape shape, const Box3d& box, float largest_radius, const ChunkLook& look) const
{
    if (shape == SplatShape::pixels) return false;
    const double radius = static_cast<double>(largest_radius) * static_cast<double>(style_.radius_scale);
    const auto least = static_cast<double>(look.least_px);
    if (shape == SplatShape::disc)
        return !(std::max(camera_.largest_box(box, radius), camera_.largest_box_of(least)) <= largest_point_);
    if (shape == SplatShape::ellipse) {
        const double box_px =
            largest_of_packed * std::max(camera_.largest_box(box, radius), camera_.largest_box_of(least)) + 2;
        return !(box_px <= largest_point_ && box_px <= 2 * guard_);
    }
    const double largest = std::max(camera_.largest_square(box, radius), least);
    return !(largest <= largest_point_ && largest <= 2 * guard_);
}

// How far from its centre a splat can be visible, source units. One of SplatShape::pixels vanishes with its centre.
double SplatSieve::reach(SplatShape shape, float largest_radius, const ChunkLook& look) const
{
    if (shape == SplatShape::pixels) return 0;
    const double radius = static_cast<double>(std::max(largest_radius * style_.radius_scale, look.least_radius));
    return camera_.squeeze * radius * (shape == SplatShape::ellipse ? largest_of_packed : 1);
}

double SplatSieve::depth_range(const Box3d& box) const
{
    if (camera_.orthographic) return 0;
    const double depth = depth_of(box.centre());
    return depth > 0 ? 0.5 * box.diagonal() * camera_.scale / depth : std::numeric_limits<double>::infinity();
}

SplatPart SplatSieve::part_of(const Box3d& box, std::uint32_t points) const
{
    // A box around the eye is treated as no nearer than a quarter of its size.
    const double depth = std::max(depth_of(box.centre()), 0.25 * box.diagonal() * camera_.scale);
    return {static_cast<double>(points), camera_.pixels_at(depth)};
}

// For a box that is partly in view or has a large depth range: estimated by its octants.
SplatPart SplatSieve::part_in_view(const Box3d& box, std::uint32_t points) const
{
    const Vec3d centre = box.centre();
    const double least_depth = 0.125 * box.diagonal() * camera_.scale;
    int in_view = 0;
    double squares = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        Vec3d place{};
        for (std::size_t a = 0; a < 3; ++a) place[a] = centre[a] + ((corner >> a) & 1 ? 0.25 : -0.25) * box.extent(a);
        if (!camera_.is_in_view(place)) continue;
        ++in_view;
        squares += std::pow(camera_.pixels_at(std::max(depth_of(place), least_depth)), 2);
    }
    if (in_view == 0) return {static_cast<double>(points) / 16, part_of(box, points).pixels_per_unit};
    return {static_cast<double>(points) * in_view / 8, std::sqrt(squares / in_view)};
}

}  // namespace pcm
