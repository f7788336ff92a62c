#include "pcm/view/vertex_discs.h"

#include "pcm/cloud/with_type.h"

#include <algorithm>
#include <cmath>

namespace pcm {

float make_radii(const Column& column, const Attribute& attribute, std::vector<float>& radii)
{
    const std::size_t points = column.size();
    const std::size_t components = column.components();
    radii.resize(points);
    float largest = 0;
    with_type(column.type(), [&](auto zero) {
        const auto* raw = column.as<decltype(zero)>();
        for (std::size_t p = 0; p < points; ++p) {
            const double value = static_cast<double>(raw[p * components]) * attribute.scale + attribute.offset;
            const double kept =
                value > 0 ? std::min(value, static_cast<double>(largest_vertex_radius)) : 0;  // false for NaN
            radii[p] = std::isinf(value) ? 0.0f : static_cast<float>(kept);
            largest = std::max(largest, radii[p]);
        }
    });
    return largest;
}

void make_normals(const Column& column, const Attribute& attribute, std::vector<float>& normals)
{
    const std::size_t points = column.size();
    const std::size_t components = column.components();
    normals.resize(3 * points);
    with_type(column.type(), [&](auto zero) {
        const auto* raw = column.as<decltype(zero)>();
        for (std::size_t p = 0; p < points; ++p) {
            double n[3];
            for (std::size_t c = 0; c < 3; ++c)
                n[c] = static_cast<double>(raw[p * components + c]) * attribute.scale + attribute.offset;
            // Scaled first: the squares of very long and very short vectors overflow or underflow.
            const double size = std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});
            const bool usable = size > 0 && std::isfinite(n[0]) && std::isfinite(n[1]) && std::isfinite(n[2]);
            double length = 0;
            if (usable) {
                for (double& v : n) v /= size;
                length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            }
            for (std::size_t c = 0; c < 3; ++c) normals[3 * p + c] = usable ? static_cast<float>(n[c] / length) : 0.0f;
        }
    });
}

}  // namespace pcm
