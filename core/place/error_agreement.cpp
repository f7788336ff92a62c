#include "pcm/place/error_agreement.h"

#include <cmath>

namespace pcm {

void ErrorAgreement::add(const Vec3d& p, double distance)
{
    if (!(edge_ > 0)) return;
    const Vec3d from_corner = p - corner_;
    CubeSum& sum = cubes_[{static_cast<int>(from_corner[0] / edge_), static_cast<int>(from_corner[1] / edge_),
                           static_cast<int>(from_corner[2] / edge_)}];
    sum.distances += distance;
    sum.squares += distance * distance;
}

void ErrorAgreement::add(const ErrorAgreement& other)
{
    for (const auto& [cube, sum] : other.cubes_) {
        cubes_[cube].distances += sum.distances;
        cubes_[cube].squares += sum.squares;
    }
}

double ErrorAgreement::factor() const
{
    double together = 0, alone = 0, fourth = 0;
    for (const auto& [cube, sum] : cubes_) {
        together += sum.distances * sum.distances;
        alone += sum.squares;
        fourth += sum.squares * sum.squares;
    }
    if (!(alone > 0)) return 1;
    const double ratio = together / alone, deviation = std::sqrt(2 * fourth) / alone;
    return ratio > 1 + 3 * deviation ? std::sqrt(ratio) : 1;
}

void enlarge(ShapeErrors& errors, double factor)
{
    errors.position *= factor;
    errors.angle *= factor;
    errors.radius *= factor;
    errors.second *= factor;
}

}  // namespace pcm
