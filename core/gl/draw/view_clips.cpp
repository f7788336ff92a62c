#include "pcm/gl/draw/view_clips.h"

#include "pcm/cloud/vector.h"

#include <cmath>
#include <utility>

namespace pcm {

std::string text_of(const std::vector<Clip>& clips)
{
    std::string text;
    for (const Clip& clip : clips) text += (clip.outside ? "outside " : "inside ") + clip.region.text() + "\n";
    return text;
}

ViewClips::ViewClips(const std::vector<Clip>& clips) : all_(clips), text_(text_of(clips))
{
    std::size_t count = 0;
    for (const Clip& clip : clips) {
        auto planes = clip.region.half_spaces();
        if (!planes || by_plane_.size() == ClipUniforms::most_clips ||
            count + planes->size() > ClipUniforms::most_planes) {
            by_point_.push_back(clip);
            continue;
        }
        count += planes->size();
        by_plane_.push_back(clip);
        planes_.push_back(std::move(*planes));
    }
}

ClipUniforms ViewClips::uniforms(const Vec3d& reference, const Vec3d& extent) const
{
    constexpr double rounding = 4.76837158203125e-07;  // 2^-21
    ClipUniforms uniforms;
    std::size_t next = 0;
    for (std::size_t c = 0; c < by_plane_.size(); ++c) {
        const Vec3d away = reference - by_plane_[c].region.centre();
        for (const Region::Plane& plane : planes_[c]) {
            double reach = 0;
            for (std::size_t a = 0; a < 3; ++a) reach += std::fabs(plane.normal[a]) * extent[a];
            const double offset = dot(plane.normal, away) + plane.offset + rounding * reach;
            // Scaled, so that float holds the planes of clouds of any size.
            const double scale = reach > 0 ? 1 / reach : 1;
            for (std::size_t a = 0; a < 3; ++a) uniforms.planes[next][a] = static_cast<float>(scale * plane.normal[a]);
            uniforms.planes[next++][3] = static_cast<float>(scale * offset);
        }
        uniforms.ends[c] = static_cast<int>(next);
        uniforms.outside |= (by_plane_[c].outside ? 1 : 0) << c;
    }
    uniforms.count = static_cast<int>(by_plane_.size());
    return uniforms;
}

}  // namespace pcm
