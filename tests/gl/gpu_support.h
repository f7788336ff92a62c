// Trees and video memory for the tests of the cursors on the device.
#pragma once

#include "tests/gl/gl_support.h"

#include "pcm/gl/compute/gpu_cursor.h"
#include "pcm/system/error.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace pcm::test {

inline constexpr std::uint64_t megabyte = 1u << 20;

inline std::vector<LasPoint> coloured_points(std::size_t count, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::vector<LasPoint> points(count);
    for (LasPoint& p : points) {
        p.x = static_cast<std::int32_t>(random() % 200000);
        p.y = static_cast<std::int32_t>(random() % 100000);
        p.z = static_cast<std::int32_t>(random() % 30000);
        p.intensity = static_cast<std::uint16_t>(random());
        p.red = static_cast<std::uint16_t>(random());
        p.green = static_cast<std::uint16_t>(random());
        p.blue = static_cast<std::uint16_t>(random());
    }
    return points;
}

inline const Grid grid{{0.001, 0.001, 0.002}, {500000, 5000000, 100}};

inline std::filesystem::path make_tree(const TemporaryFolder& folder, const std::string& name,
                                       std::size_t points = 60000)
{
    make_cloud(folder, name, grid, coloured_points(points, points), 7000);
    return folder / (name + ".pct");
}

inline std::shared_ptr<L1Cache> make_l1(std::uint64_t capacity)
{
    L1Options options;
    options.block_bytes = megabyte;
    options.capacity_bytes = capacity;
    return std::make_shared<L1Cache>(options);
}

inline std::vector<std::byte> bytes_of(const BufferRange& range)
{
    std::vector<std::byte> bytes(range.bytes);
    glBindBuffer(GL_COPY_WRITE_BUFFER, range.buffer);
    glGetBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(range.offset), static_cast<GLsizeiptr>(range.bytes),
                       bytes.data());
    return bytes;
}

}  // namespace pcm::test
