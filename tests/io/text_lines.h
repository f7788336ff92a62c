// Shared by the tests of text writers: clouds of awkward values, and files parsed without the library.
#pragma once

#include "pcm/io/writer.h"
#include "tests/io/bytes.h"

#include <cmath>
#include <limits>
#include <sstream>

namespace pcm::test {

inline std::vector<std::string> lines_of(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
}

inline std::vector<std::string> fields_of(const std::string& line, char separator)
{
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, separator);) fields.push_back(field);
    return fields;
}

// Random bits: small and large numbers, subnormal ones, -0, NaN, infinities.
inline double any_double(std::mt19937_64& random)
{
    switch (random() % 6) {
        case 0: {
            const std::uint64_t bits = random();
            double value;
            std::memcpy(&value, &bits, 8);
            return value;
        }
        case 1:
            return static_cast<double>(random() % 100000000) / 1000;
        case 2:
            return static_cast<double>(static_cast<std::int64_t>(random()));
        case 3:
            return 5e6 + static_cast<double>(random() % 1000000) * 1e-3;
        case 4:
            return std::array{0.0, -0.0, 1e15, 1e-5, 1e23, 0.1, -1e-300}[random() % 7];
        default:
            return std::array{std::numeric_limits<double>::quiet_NaN(),  -std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity(),   -std::numeric_limits<double>::infinity(),
                              std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max(),
                              -std::numeric_limits<double>::max()}[random() % 7];
    }
}

// Equal bit for bit, except that all NaN are equal.
inline bool same(double a, double b) { return std::isnan(a) ? std::isnan(b) : std::memcmp(&a, &b, sizeof a) == 0; }
inline bool same(float a, float b) { return std::isnan(a) ? std::isnan(b) : std::memcmp(&a, &b, sizeof a) == 0; }

inline PointBatch batch_of(const FileInfo& cloud, std::size_t points)
{
    PointBatch batch;
    batch.reset(cloud.schema, cloud.grid.has_value(), points);
    return batch;
}

// Writes one batch; returns the notes.
inline std::vector<std::string> write_cloud(const std::filesystem::path& path, const FileInfo& cloud,
                                            const PointBatch& batch, const WriteOptions& options = {})
{
    const auto writer = create_writer(path, cloud, options);
    writer->write(batch);
    writer->finish();
    return writer->notes();
}

}  // namespace pcm::test
