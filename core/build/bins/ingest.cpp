#include "pcm/build/bins/ingest.h"

#include "pcm/build/bins/strided_sample.h"

#include <algorithm>
#include <cmath>

namespace pcm {

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
        for (std::size_t i = 0; i < batch.size; ++i)
            points.push_back({to_coordinate<std::uint32_t>(batch.grid_xyz[0][i]),
                              to_coordinate<std::uint32_t>(batch.grid_xyz[1][i]),
                              to_coordinate<std::uint32_t>(batch.grid_xyz[2][i])});
    }
    cloud.seek(0);
    return points;
}

namespace {

// Copies a column's values to their places in the rows. Frequent sizes get a copy of a length that the compiler knows.
template <std::size_t Size>
void scatter(const std::byte* from, std::size_t count, std::byte* to, std::size_t stride)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * stride, from + i * Size, Size);
}

}  // namespace

void put_attributes(const PointBatch& batch, const RowLayout& layout, std::byte* rows)
{
    for (std::size_t k = 0; k < layout.offsets.size(); ++k) {
        const std::byte* from = batch.attributes[k].data();
        const std::size_t size = layout.sizes[k];
        std::byte* to = rows + layout.offsets[k];
        switch (size) {
            case 1:
                scatter<1>(from, batch.size, to, layout.bytes);
                break;
            case 2:
                scatter<2>(from, batch.size, to, layout.bytes);
                break;
            case 3:
                scatter<3>(from, batch.size, to, layout.bytes);
                break;
            case 4:
                scatter<4>(from, batch.size, to, layout.bytes);
                break;
            case 6:
                scatter<6>(from, batch.size, to, layout.bytes);
                break;
            case 8:
                scatter<8>(from, batch.size, to, layout.bytes);
                break;
            case 12:
                scatter<12>(from, batch.size, to, layout.bytes);
                break;
            default:
                for (std::size_t i = 0; i < batch.size; ++i) std::memcpy(to + i * layout.bytes, from + i * size, size);
        }
    }
}

std::int64_t to_grid_position(double value, double scale, double offset)
{
    return static_cast<std::int64_t>(std::llrint((value - offset) / scale));
}

}  // namespace pcm
