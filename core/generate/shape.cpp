#include "pcm/generate/shape.h"

#include <algorithm>
#include <cmath>

namespace pcm::scene {

Box3d Shape::box() const
{
    Box3d box;
    // A dome is not wider than its rim where that is above the sphere's middle.
    const double rim = lowest - centre[2];
    const double girth = rim > 0 ? std::sqrt(std::max(0.0, radius * radius - rim * rim)) : radius;
    for (std::size_t a = 0; a < 3; ++a) {
        double below = 0, above = 0;
        switch (kind) {
            case Kind::rectangle:
                below = above = std::abs(u[a]) * half_u + std::abs(v[a]) * half_v;
                above += std::max(0.0, v[a] * gable);
                below += std::max(0.0, -v[a] * gable);
                break;
            case Kind::disc:
                below = above = radius * std::sqrt(std::max(0.0, 1 - n[a] * n[a]));
                break;
            case Kind::cylinder:
                below = above = std::abs(n[a]) * half_v + radius * std::sqrt(std::max(0.0, 1 - n[a] * n[a]));
                break;
            case Kind::sphere:
                below = above = a == 2 ? radius : girth;
                break;
            case Kind::crown:
                below = above = radius;
                break;
        }
        box.min[a] = centre[a] - below - 1e-9;
        box.max[a] = centre[a] + above + 1e-9;
    }
    box.min[2] = std::max(box.min[2], lowest);
    return box;
}

}  // namespace pcm::scene
