#include "pcm/shapes/moved_primitive.h"

#include "pcm/system/error.h"

#include <cmath>

namespace pcm {

std::optional<std::array<Vec3d, 3>> rotation_of(const std::array<Vec3d, 3>& linear)
{
    constexpr double tolerance = 1e-5;
    constexpr int steps = 4;  // each squares what is wrong
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            if (!(std::fabs(dot(linear[i], linear[j]) - (i == j)) <= tolerance)) return std::nullopt;
    std::array<Vec3d, 3> rows = linear;
    if (dot(rows[0], cross(rows[1], rows[2])) < 0) return std::nullopt;
    // The mean of a matrix and its inverse transposed is nearer to the rotation of its polar decomposition.
    for (int step = 0; step < steps; ++step) {
        const std::array<Vec3d, 3> cofactors{cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])};
        const double determinant = dot(rows[0], cofactors[0]);
        for (std::size_t i = 0; i < 3; ++i) rows[i] = 0.5 * (rows[i] + (1 / determinant) * cofactors[i]);
    }
    return rows;
}

Primitive moved(Primitive primitive, const Affine& map)
{
    const auto refuse = [&](const std::string& what) {
        throw Error(ErrorCode::invalid_argument, {}, primitive.name + " cannot be moved: " + what);
    };
    if (!is_finite(map.pivot) || !is_finite(map.target)) refuse("the map has numbers that are not finite");
    const auto rotation = rotation_of(map.linear);
    if (!rotation) refuse("the map is not a rotation and a shift, but scales, shears or mirrors");
    Affine motion = map;
    motion.linear = *rotation;
    const auto turned = [&](const Vec3d& v) {
        return Vec3d{dot(motion.linear[0], v), dot(motion.linear[1], v), dot(motion.linear[2], v)};
    };
    Shape& shape = primitive.fit.shape;
    shape.point = motion(shape.point);
    if (traits_of(shape.kind).axis) shape.axis = normalised(turned(shape.axis));
    for (Vec3d& corner : primitive.bounds.outline) corner = motion(corner);
    if (primitive.bounds.zero != Vec3d{}) primitive.bounds.zero = normalised(turned(primitive.bounds.zero));
    return primitive;
}

}  // namespace pcm
