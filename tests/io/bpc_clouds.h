// Random clouds for the tests of BPC: any schema, any bit pattern, points on a grid or doubles of several kinds.
#pragma once

#include "tests/io/bytes.h"

#include "pcm/io/writer.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace pcm::test {

inline FileInfo random_cloud_info(std::mt19937_64& random, bool gridded)
{
    FileInfo info;
    const std::size_t attributes = random() % 6;
    for (std::size_t i = 0; i < attributes; ++i)
        info.schema.add({"a" + std::to_string(i), static_cast<ScalarType>(1 + random() % 10),
                         1 + static_cast<std::uint32_t>(random() % 4), 0.25 * double(random() % 5 + 1),
                         double(random() % 3), random() % 2 ? "described" : ""});
    info.position_type = gridded ? ScalarType::i32 : random() % 2 ? ScalarType::f32 : ScalarType::f64;
    if (gridded) info.grid = Grid{{0.001, 1e-7, 12.5}, {5e6, -0.25, 0}};
    const std::size_t blocks = random() % 4;
    for (std::size_t i = 0; i < blocks; ++i) {
        Metadata block{"key/" + std::to_string(random() % 100), {}};
        for (std::size_t k = random() % 300; k > 0; --k) block.value.push_back(static_cast<std::byte>(random()));
        info.metadata.push_back(block);
    }
    return info;
}

inline double random_double(std::mt19937_64& random, int kind)
{
    const auto integer = static_cast<double>(static_cast<std::int64_t>(random() % 2000000) - 1000000);
    switch (kind) {
        case 0:
            return integer / 1000;
        case 1:
            return std::ldexp(integer, -12);
        case 2:
            return static_cast<double>(static_cast<float>(integer) * 0.1f);
        case 3:
            return integer * 0.1234567891234567;
        default: {
            static const double special[] = {std::numeric_limits<double>::quiet_NaN(),
                                             -0.0,
                                             std::numeric_limits<double>::infinity(),
                                             1e-300,
                                             1e9,
                                             5e-324};
            std::uint64_t bits = random();
            double value;
            std::memcpy(&value, &bits, 8);
            return random() % 2 ? special[random() % 6] : value;
        }
    }
}

inline PointBatch random_points(std::mt19937_64& random, const FileInfo& info, std::size_t points)
{
    PointBatch batch;
    batch.reset(info.schema, info.grid.has_value(), points);
    for (std::size_t a = 0; a < 3; ++a) {
        const int kind = static_cast<int>(random() % 5);
        const unsigned shift = static_cast<unsigned>(random() % 32);
        for (auto& v : batch.grid_xyz[a]) v = static_cast<std::int32_t>(random()) >> shift;
        for (auto& v : batch.xyz[a]) v = random_double(random, kind);
    }
    for (Column& column : batch.attributes) {
        const bool constant = random() % 4 == 0;
        for (std::size_t i = 0; i < column.bytes(); ++i)
            column.data()[i] = static_cast<std::byte>(constant ? 7 : random());
    }
    return batch;
}

inline PointBatch part_of(const PointBatch& all, const Schema& schema, std::size_t first, std::size_t count)
{
    PointBatch batch;
    batch.reset(schema, all.gridded, count);
    for (std::size_t a = 0; a < 3; ++a) {
        if (all.gridded)
            std::copy_n(all.grid_xyz[a].data() + first, count, batch.grid_xyz[a].data());
        else
            std::copy_n(all.xyz[a].data() + first, count, batch.xyz[a].data());
    }
    for (std::size_t i = 0; i < schema.size(); ++i)
        std::memcpy(batch.attributes[i].data(), all.attributes[i].data() + first * schema[i].bytes(),
                    count * schema[i].bytes());
    return batch;
}

// Bit for bit: NaN equals itself, 0 is not -0.
inline bool same_bits(const PointBatch& a, const PointBatch& b)
{
    bool same = a.size == b.size && a.gridded == b.gridded && a.attributes.size() == b.attributes.size();
    for (std::size_t k = 0; same && k < 3; ++k)
        same = a.grid_xyz[k] == b.grid_xyz[k] && a.xyz[k].size() == b.xyz[k].size() &&
               (a.xyz[k].empty() || std::memcmp(a.xyz[k].data(), b.xyz[k].data(), a.xyz[k].size() * 8) == 0);
    for (std::size_t i = 0; same && i < a.attributes.size(); ++i)
        same = a.attributes[i].bytes() == b.attributes[i].bytes() &&
               (a.attributes[i].bytes() == 0 ||
                std::memcmp(a.attributes[i].data(), b.attributes[i].data(), a.attributes[i].bytes()) == 0);
    return same;
}

inline void write_cloud(const std::filesystem::path& path, const FileInfo& info, const PointBatch& points,
                        std::size_t batch_points = 50000)
{
    const auto writer = create_writer(path, info);
    for (std::size_t done = 0; done < points.size; done += batch_points)
        writer->write(part_of(points, info.schema, done, std::min(batch_points, points.size - done)));
    writer->finish();
}

}  // namespace pcm::test
