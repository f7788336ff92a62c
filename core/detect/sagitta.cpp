#include "pcm/detect/sagitta.h"

#include <algorithm>
#include <cmath>

namespace pcm {

double turn_of(const Shape& shape, const std::vector<Vec3d>& points)
{
    if (points.empty()) return 0;
    Vec3d far = normal_at(shape, points.front());
    double cosine = 1;
    for (int round = 0; round < 2; ++round) {
        const Vec3d from = far;
        cosine = 1;
        for (const Vec3d& p : points) {
            const Vec3d normal = normal_at(shape, p);
            if (const double c = dot(normal, from); c < cosine) {
                cosine = c;
                far = normal;
            }
        }
    }
    return std::acos(std::clamp(cosine, -1.0, 1.0));
}

double sagitta_of(const Shape& shape, double turn)
{
    return traits_of(shape.kind).is_flat() ? 0 : shape.radius * (1 - std::cos(turn / 2));
}

}  // namespace pcm
