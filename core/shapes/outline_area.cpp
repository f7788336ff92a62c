#include "pcm/shapes/outline_area.h"

#include "pcm/shapes/primitive.h"

#include <cmath>

namespace pcm {

namespace {

bool is_rectangle(const std::vector<Vec3d>& corners)
{
    constexpr double right = 1e-6;  // tolerance of the cosine
    if (corners.size() != 4) return false;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3d one = corners[(i + 1) % 4] - corners[i], other = corners[(i + 3) % 4] - corners[i];
        if (!(std::fabs(dot(one, other)) <= right * length(one) * length(other))) return false;
    }
    return true;
}

}  // namespace

const char* name_of(OutlineForm form)
{
    switch (form) {
        case OutlineForm::rectangle:
            return "rectangle";
        case OutlineForm::convex:
            return "convex";
        case OutlineForm::concave:
            return "concave";
        default:
            return "none";
    }
}

OutlineArea outline_area(const std::vector<Vec3d>& corners, std::uint64_t points)
{
    OutlineArea found;
    if (corners.size() < 3) return found;
    Vec3d sum{};
    double perimeter = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d next = corners[(i + 1) % corners.size()] - corners[0];
        sum = sum + cross(corners[i] - corners[0], next);
        perimeter += length(corners[(i + 1) % corners.size()] - corners[i]);
    }
    found.area = length(sum) / 2;
    if (is_rectangle(corners)) {
        found.form = OutlineForm::rectangle;
        return found;
    }
    found.form = OutlineForm::convex;
    const double scale = 1e-9 * length(sum);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d& corner = corners[(i + 1) % corners.size()];
        const Vec3d turned = cross(corner - corners[i], corners[(i + 2) % corners.size()] - corner);
        if (dot(turned, sum) < -scale * length(sum)) found.form = OutlineForm::concave;
    }
    if (points > 0) found.uncertainty = perimeter * std::sqrt(found.area / static_cast<double>(points)) / 2;
    return found;
}

OutlineArea area_of(const Primitive& primitive)
{
    return traits_of(primitive.fit.shape.kind).area(primitive.bounds, primitive.points);
}

std::string words_of(OutlineForm form)
{
    if (form == OutlineForm::none) return "";
    return "in the " + std::string(name_of(form)) +
           (form == OutlineForm::rectangle ? " around its points" : " outline of its points");
}

}  // namespace pcm
