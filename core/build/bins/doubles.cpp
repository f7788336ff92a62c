#include "pcm/build/bins/doubles.h"

#include "pcm/build/bins/ingest.h"
#include "pcm/build/bins/position_grid.h"
#include "pcm/cloud/vector.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcm {

std::size_t DoubleRows::put(const PointBatch& batch, std::vector<std::byte>& rows)
{
    rows.resize(batch.size * layout_.bytes);
    put_attributes(batch, layout_, rows.data());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < batch.size; ++i) {
        const Vec3d p{batch.xyz[0][i], batch.xyz[1][i], batch.xyz[2][i]};
        if (!is_finite(p)) continue;
        std::byte* row = rows.data() + kept++ * layout_.bytes;
        if (row != rows.data() + i * layout_.bytes) std::memmove(row, rows.data() + i * layout_.bytes, layout_.bytes);
        std::memcpy(row, p.data(), sizeof p);
        for (std::size_t a = 0; a < 3 && counts_decimals_; ++a) decimals_[a].see(p[a]);
    }
    return kept;
}

std::string note_of_skipped(std::uint64_t points)
{
    return std::to_string(points) + " points without a finite position were left out";
}

bool counts_decimals(const FileInfo& info) { return info.position_type == ScalarType::f64; }

bool choose_grid(const FileInfo& info, const FarPoints& positions, Ingested& found)
{
    const Box3d& box = positions.box();
    if (info.near_grid && resolves(*info.near_grid, box)) {
        const Grid grid = *info.near_grid;
        check_tree_grid(grid);
        found.grid = grid;
        found.position_type = ScalarType::i32;
        found.decimals = {no_decimals, no_decimals, no_decimals};
        bool narrow = true;
        for (std::size_t a = 0; a < 3 && !box.empty(); ++a)
            for (const double end : {box.min[a], box.max[a]}) {
                const std::int64_t q = to_grid_position(end, grid.scale[a], grid.offset[a]);
                narrow = narrow && q >= std::numeric_limits<std::int32_t>::min() &&
                         q <= std::numeric_limits<std::int32_t>::max();
            }
        return narrow;
    }
    check_tree_positions(positions);
    found.grid = power_of_two_grid(box);
    return false;
}

template <class Coord>
std::array<Coord, 3> GridRows<Coord>::on_grid(const Vec3d& p) const
{
    std::array<Coord, 3> c;
    for (std::size_t a = 0; a < 3; ++a)
        c[a] = to_coordinate<Coord>(to_grid_position(p[a], grid_.scale[a], grid_.offset[a]));
    return c;
}

template <class Coord>
std::byte* GridRows<Coord>::convert(std::byte* row, std::size_t row_bytes, Observed& seen, bool& rounded) const
{
    static_assert(sizeof(Coord) <= sizeof(double));
    Vec3d p;
    std::memcpy(p.data(), row, sizeof p);
    const std::array<Coord, 3> c = on_grid(p);
    row += 3 * (sizeof(double) - sizeof(Coord));
    std::memcpy(row, c.data(), sizeof c);
    Vec3i q;
    for (std::size_t a = 0; a < 3; ++a) {
        q[a] = to_grid<Coord>(c[a]);
        const double stored = grid_.to_source(q[a], a);
        if (stored == p[a]) continue;
        rounded = true;
        seen.position_error = std::max(seen.position_error, std::fabs(rounding_(stored, a) - p[a]));
    }
    seen.see(q);
    seen.hash += hash_rows(row, 1, row_bytes);
    return row;
}

template class GridRows<std::uint32_t>;
template class GridRows<std::uint64_t>;

}  // namespace pcm
