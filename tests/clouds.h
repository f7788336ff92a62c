// Small clouds for tests, and files of them written byte by byte, independent of the library's writers.
#pragma once

#include "pcm/cloud/geometry.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

namespace pcm::test {

// LAS 1.2, point format 0 or 2, with only what the specification requires.
struct LasRecord {
    std::int32_t x, y, z;
    std::uint16_t intensity;
    std::uint8_t returns, classification;
    std::int8_t angle;
    std::uint8_t user;
    std::uint16_t source;
    std::uint16_t red, green, blue;
};

inline void write_las(const std::filesystem::path& path, const std::vector<LasRecord>& points, const Grid& grid)
{
    std::vector<char> header(227, 0);
    const auto put = [&](std::size_t at, auto value) { std::memcpy(header.data() + at, &value, sizeof value); };
    std::memcpy(header.data(), "LASF", 4);
    header[24] = 1;
    header[25] = 2;
    put(94, std::uint16_t(227));
    put(96, std::uint32_t(227));
    header[104] = 2;
    put(105, std::uint16_t(26));
    put(107, static_cast<std::uint32_t>(points.size()));
    for (std::size_t a = 0; a < 3; ++a) {
        put(131 + 8 * a, grid.scale[a]);
        put(155 + 8 * a, grid.offset[a]);
    }
    std::ofstream file(path, std::ios::binary);
    file.write(header.data(), 227);
    for (const LasRecord& p : points) {
        char r[26];
        std::memcpy(r, &p.x, 4);
        std::memcpy(r + 4, &p.y, 4);
        std::memcpy(r + 8, &p.z, 4);
        std::memcpy(r + 12, &p.intensity, 2);
        r[14] = static_cast<char>(p.returns);
        r[15] = static_cast<char>(p.classification);
        r[16] = static_cast<char>(p.angle);
        r[17] = static_cast<char>(p.user);
        std::memcpy(r + 18, &p.source, 2);
        std::memcpy(r + 20, &p.red, 2);
        std::memcpy(r + 22, &p.green, 2);
        std::memcpy(r + 24, &p.blue, 2);
        file.write(r, 26);
    }
}

template <class Scalar>
void write_ply(const std::filesystem::path& path, const std::vector<std::array<Scalar, 3>>& points)
{
    std::ofstream file(path, std::ios::binary);
    const char* type = sizeof(Scalar) == 8 ? "double" : "float";
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size() << "\n";
    for (const char* axis : {"x", "y", "z"}) file << "property " << type << " " << axis << "\n";
    file << "end_header\n";
    file.write(reinterpret_cast<const char*>(points.data()),
               static_cast<std::streamsize>(points.size() * sizeof(points[0])));
}

enum class Shape { surface, volume, line, coincident, duplicates, clusters, full_range };

// `count` grid positions from a distribution that is difficult for trees.
inline std::vector<LasRecord> records(Shape shape, std::size_t count, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::vector<LasRecord> points(count);
    for (LasRecord& p : points) {
        const auto any = [&](std::int64_t low, std::int64_t high) {
            return static_cast<std::int32_t>(
                low + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(high - low + 1)));
        };
        switch (shape) {
            case Shape::surface:
                p.x = any(0, 100000);
                p.y = any(0, 60000);
                p.z = p.x / 7 + p.y / 11 + any(-3, 3);
                break;
            case Shape::volume:
                p.x = any(-50000, 50000), p.y = any(-50000, 50000), p.z = any(-50000, 50000);
                break;
            case Shape::line:
                p.x = any(0, 1000000), p.y = 17, p.z = -3;
                break;
            case Shape::coincident:
                p.x = 1, p.y = 2, p.z = 3;
                break;
            case Shape::duplicates:
                p.x = any(0, 9), p.y = any(0, 4), p.z = 0;
                break;
            case Shape::clusters: {
                // Some hundred units wide, at the ends of the 32-bit range.
                const std::int64_t corner = random() & 1 ? 2147482000 : -2147483000;
                p.x = any(corner, corner + 600), p.y = any(corner, corner + 600), p.z = any(corner, corner + 600);
                break;
            }
            case Shape::full_range:
                p.x = static_cast<std::int32_t>(random());
                p.y = static_cast<std::int32_t>(random());
                p.z = static_cast<std::int32_t>(random());
                break;
        }
        p.intensity = static_cast<std::uint16_t>(random());
        p.returns = static_cast<std::uint8_t>(random());
        p.classification = static_cast<std::uint8_t>(random());
        p.angle = static_cast<std::int8_t>(random());
        p.user = static_cast<std::uint8_t>(random());
        p.source = static_cast<std::uint16_t>(random());
        p.red = static_cast<std::uint16_t>(random());
        p.green = static_cast<std::uint16_t>(random());
        p.blue = static_cast<std::uint16_t>(random());
    }
    return points;
}

inline const char* name(Shape shape)
{
    static const char* names[] = {"surface", "volume", "line", "coincident", "duplicates", "clusters", "full_range"};
    return names[static_cast<int>(shape)];
}

}  // namespace pcm::test
