#include "pcm/build/bins/ingest.h"

#include "pcm/build/bins/strided_sample.h"
#include "pcm/system/copy_strided.h"

#include <algorithm>
#include <cmath>

namespace pcm {

std::array<std::uint32_t, 3> coordinates_of(const PointBatch& batch, std::size_t i)
{
    return {to_coordinate<std::uint32_t>(batch.grid_xyz[0][i]), to_coordinate<std::uint32_t>(batch.grid_xyz[1][i]),
            to_coordinate<std::uint32_t>(batch.grid_xyz[2][i])};
}

std::vector<std::array<std::uint32_t, 3>> sample_evenly(PointReader& cloud)
{
    // Runs of neighbours cost one read; a run holds few points, so that all parts of the cloud are seen.
    constexpr std::uint64_t run = 8;
    const std::uint64_t end = cloud.info().points;
    const std::uint64_t stride = run * sample_stride(end);
    std::vector<std::array<std::uint32_t, 3>> points;
    points.reserve(end / stride * run + run);
    PointBatch batch;
    for (std::uint64_t next = 0; next < end; next += stride) {
        cloud.seek(next);
        if (!cloud.read(batch, static_cast<std::size_t>(std::min(run, end - next)))) break;
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

std::int64_t to_grid_position(double value, double scale, double offset)
{
    return static_cast<std::int64_t>(std::llrint((value - offset) / scale));
}

}  // namespace pcm
