#include "pcm/shapes/shape_lines.h"

#include <cmath>

namespace pcm {
namespace {

constexpr double margin = 0.01;  // share of a box around curved lines

bool all_finite(const std::vector<ShapeLine>& lines)
{
    for (const ShapeLine& line : lines)
        for (const Vec3d& p : line.points)
            if (!is_finite(p)) return false;
    return true;
}

}  // namespace

std::vector<ShapeLine> shape_lines(const Shape& shape, const ShapeBounds& bounds, const ShapeLineOptions& options)
{
    const bool finite = std::isfinite(bounds.begin) && std::isfinite(bounds.end) && std::isfinite(shape.radius);
    if (!bounds.known(shape.kind) || !finite) return {};
    std::vector<ShapeLine> lines = traits_of(shape.kind).lines(shape, bounds, options);
    if (!all_finite(lines)) lines.clear();
    return lines;
}

Box3d box_of(const Shape& shape, const ShapeBounds& bounds)
{
    Box3d box;
    for (const ShapeLine& line : shape_lines(shape, bounds))
        if (!line.is_axis)
            for (const Vec3d& p : line.points) box.extend(p);
    if (box.empty() || traits_of(shape.kind).is_flat()) return box;
    const double more = margin * box.diagonal();
    for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] -= more;
        box.max[a] += more;
    }
    return box;
}

}  // namespace pcm
