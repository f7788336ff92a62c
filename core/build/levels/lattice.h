// The lattice of cells that sampling and sorting share: nearly cubes, as far as the grid allows, whose sides double
// from one size to the next. Cells are aligned in the whole cloud's coordinates, so they nest and do not depend on how
// the cloud is divided.
//
// A cell of size g is 2^(g + finer[a]) grid steps along axis a. Two points of one cell are less than spacing(g) apart,
// and points nearer than spacing(g) to each other are at most 4 cells apart along any axis.
#pragma once

#include "pcm/build/bins/cut.h"
#include "pcm/cloud/geometry.h"
#include "pcm/cloud/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace pcm {

template <class Coord>
using Point = std::array<Coord, 3>;  // biased grid coordinates, as in rows (row.h)

struct Lattice {
    Vec3d scale{1, 1, 1};      // step of the grid, source units
    AxisShift finer{0, 0, 0};  // such that scale[a] << finer[a] agrees within a factor of 2 on all axes

    Lattice() = default;
    explicit Lattice(const Grid& grid) : scale(grid.scale), finer(axis_shift(grid)) {}

    // The diagonal of a cell of size g, source units.
    double spacing(int g) const
    {
        double sum = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const double side = std::ldexp(scale[a], finer[a]);
            sum += side * side;
        }
        return std::ldexp(std::sqrt(sum), g);
    }

    // How far coordinates are shifted down to become cells of size g.
    std::array<int, 3> shifts(int g) const
    {
        return {std::min(63, g + finer[0]), std::min(63, g + finer[1]), std::min(63, g + finer[2])};
    }

    // The size of cells such that the box between the two points touches at most 8.
    template <class Coord>
    int size_of_box(const Point<Coord>& low, const Point<Coord>& high) const
    {
        int bits = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::uint64_t extent = static_cast<std::uint64_t>(high[a] - low[a]) >> finer[a];
            bits = std::max(bits, extent ? 64 - __builtin_clzll(extent) : 0);
        }
        return bits;
    }
};

template <class Coord>
bool same_cell(const Point<Coord>& p, const Point<Coord>& q, const std::array<int, 3>& shifts)
{
    return !((static_cast<std::uint64_t>(p[0] ^ q[0]) >> shifts[0]) |
             (static_cast<std::uint64_t>(p[1] ^ q[1]) >> shifts[1]) |
             (static_cast<std::uint64_t>(p[2] ^ q[2]) >> shifts[2]));
}

// The size of the largest cells that separate p and q; -1 when one cell of size 0 holds both.
template <class Coord>
int parting_size(const Point<Coord>& p, const Point<Coord>& q, const AxisShift& finer)
{
    std::uint64_t differ = 0;
    for (std::size_t a = 0; a < 3; ++a) differ |= static_cast<std::uint64_t>(p[a] ^ q[a]) >> finer[a];
    return differ ? 63 - __builtin_clzll(differ) : -1;
}

// Morton order of all cells down to size 0, z before y before x, then by coordinates. Cells of every size are runs in
// it.
template <class Coord>
bool morton_before(const Point<Coord>& p, const Point<Coord>& q, const AxisShift& finer)
{
    std::size_t axis = 2;
    std::uint64_t most = static_cast<std::uint64_t>(p[2] ^ q[2]) >> finer[2];
    for (const std::size_t a : {std::size_t{1}, std::size_t{0}}) {
        const std::uint64_t differ = static_cast<std::uint64_t>(p[a] ^ q[a]) >> finer[a];
        if (most < differ && most < (most ^ differ)) {  // the highest bit of `differ` is above that of `most`
            axis = a;
            most = differ;
        }
    }
    return most ? p[axis] < q[axis] : p < q;
}

}  // namespace pcm
