#include "pcm/build/bins/ingest.h"

#include "pcm/build/bins/strided_sample.h"
#include "pcm/system/copy_strided.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pcm {

std::array<std::uint32_t, 3> coordinates_of(const PointBatch& batch, std::size_t i)
{
    return {to_coordinate<std::uint32_t>(batch.grid_xyz[0][i]), to_coordinate<std::uint32_t>(batch.grid_xyz[1][i]),
            to_coordinate<std::uint32_t>(batch.grid_xyz[2][i])};
}

std::vector<std::array<std::uint32_t, 3>> sample_evenly(PointReader& cloud) { return sample_evenly(cloud, 0, 1); }

std::vector<std::array<std::uint32_t, 3>> sample_evenly(PointReader& cloud, unsigned share, unsigned shares)
{
    // Runs of neighbours cost one read; a run holds few points, so that all parts of the cloud are seen.
    constexpr std::uint64_t run = 8;
    const std::uint64_t points_of_cloud = cloud.info().points;
    const std::uint64_t stride = run * sample_stride(points_of_cloud);
    const std::uint64_t runs = (points_of_cloud + stride - 1) / stride;
    const std::uint64_t first = runs * share / shares, end = runs * (share + 1) / shares;
    std::vector<std::array<std::uint32_t, 3>> points;
    points.reserve((end - first) * run);
    PointBatch batch;
    for (std::uint64_t next = first * stride; next < std::min(points_of_cloud, end * stride); next += stride) {
        cloud.seek(next);
        if (!cloud.read(batch, static_cast<std::size_t>(std::min(run, points_of_cloud - next)))) break;
        for (std::size_t i = 0; i < batch.size; ++i) points.push_back(coordinates_of(batch, i));
    }
    cloud.seek(0);
    return points;
}

void put_attributes(const PointBatch& batch, const RowLayout& layout, std::byte* rows)
{
    for (std::size_t k = 0; k < layout.offsets.size(); ++k)
        copy_strided(layout.sizes[k], batch.attributes[k].data(), layout.sizes[k], rows + layout.offsets[k],
                     layout.bytes, batch.size);
}

void put_gridded_rows(const PointBatch& batch, const RowLayout& layout, std::vector<std::byte>& rows,
                      Observed& observed)
{
    rows.resize(batch.size * layout.bytes);
    put_attributes(batch, layout, rows.data());
    for (std::size_t i = 0; i < batch.size; ++i) {
        std::array<std::uint32_t, 3> c;
        for (std::size_t a = 0; a < 3; ++a) c[a] = to_coordinate<std::uint32_t>(batch.grid_xyz[a][i]);
        std::memcpy(rows.data() + i * layout.bytes, c.data(), sizeof c);
    }
    observed.see(batch.grid_xyz, batch.size);
    observed.hash += hash_rows(rows.data(), batch.size, layout.bytes);
}

std::int64_t to_grid_position(double value, double scale, double offset)
{
    return static_cast<std::int64_t>(std::llrint((value - offset) / scale));
}

}  // namespace pcm
