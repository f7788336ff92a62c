#include "pcm/view/motion.h"

namespace pcm {

std::optional<Camera> predict(const Camera& before, const Camera& now, unsigned frames)
{
    if (before.origin != now.origin || before.width != now.width || before.height != now.height ||
        before.projection != now.projection || before.modelview == now.modelview || !is_affine(before.modelview) ||
        !is_affine(now.modelview))
        return std::nullopt;
    Matrix4d from = before.modelview, to = now.modelview;
    const double from_scale = from[15], to_scale = to[15];
    for (double& v : from) v /= from_scale;
    for (double& v : to) v /= to_scale;
    const auto back = affine_inverse(from);
    if (!back) return std::nullopt;
    const Matrix4d step = product(to, *back);
    Camera view = now;
    view.modelview = to;
    for (unsigned frame = 0; frame < frames; ++frame) view.modelview = product(step, view.modelview);
    if (!is_affine(view.modelview)) return std::nullopt;  // overflow
    return view;
}

}  // namespace pcm
