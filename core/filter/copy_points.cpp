#include "pcm/filter/copy_points.h"

#include <cstring>

namespace pcm {
namespace {

template <std::size_t Size>
void gather(const std::byte* from, const std::uint32_t* points, std::size_t count, std::byte* to)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * Size, from + points[i] * Size, Size);
}

}  // namespace

void copy_points(const Column& from, const std::uint32_t* points, std::size_t count, std::byte* to)
{
    const std::size_t size = from.point_bytes();
    if (count == 0) return;
    if (!points) {
        std::memcpy(to, from.data(), count * size);
        return;
    }
    switch (size) {
        case 1:
            return gather<1>(from.data(), points, count, to);
        case 2:
            return gather<2>(from.data(), points, count, to);
        case 4:
            return gather<4>(from.data(), points, count, to);
        case 6:
            return gather<6>(from.data(), points, count, to);
        case 8:
            return gather<8>(from.data(), points, count, to);
        default:
            for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * size, from.data() + points[i] * size, size);
    }
}

}  // namespace pcm
