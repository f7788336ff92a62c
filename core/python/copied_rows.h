// Positions and values of the points in view, as rows. `View`: PointView or EditView.
#pragma once

#include "pcm/cloud/point_batch.h"
#include "pcm/python/values.h"

#include <cstddef>
#include <cstring>
#include <type_traits>

namespace pcm::python {

template <class View>
void add_positions(Rows& rows, const View& view)
{
    auto* xyz = reinterpret_cast<double*>(rows.add(view.size()));
    for (std::size_t i = 0; i < view.size(); ++i, xyz += 3) {
        const Vec3d p = view.position(i);
        xyz[0] = p[0];
        xyz[1] = p[1];
        xyz[2] = p[2];
    }
}

// Raw values. `column`: those of the view's chunk, selected or not.
template <class View>
void add_values(Rows& rows, const Column& column, const View& view)
{
    std::byte* const out = rows.add(view.size());
    const std::byte* const values = column.data();
    // Lengths that the compiler knows are copied by a move or two.
    const auto copy = [&](const auto bytes) {
        for (std::size_t i = 0; i < view.size(); ++i)
            std::memcpy(out + i * bytes, values + view.index(i) * bytes, bytes);
    };
    switch (column.point_bytes()) {
        case 1:
            return copy(std::integral_constant<std::size_t, 1>());
        case 2:
            return copy(std::integral_constant<std::size_t, 2>());
        case 4:
            return copy(std::integral_constant<std::size_t, 4>());
        case 6:
            return copy(std::integral_constant<std::size_t, 6>());
        case 8:
            return copy(std::integral_constant<std::size_t, 8>());
        default:
            return copy(column.point_bytes());
    }
}

}  // namespace pcm::python
