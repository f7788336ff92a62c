// Shared by the tests of readers: files made byte by byte, and whole files read back.
#pragma once

#include "pcm/io/reader.h"
#include "tests/outcome.h"
#include "tests/support.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace pcm::test {

// Little-endian bytes, appended one by one, without the code under test.
class Bytes {
public:
    template <class T>
    Bytes& put(T value)
    {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof value);
        for (std::size_t i = 0; i < sizeof value; ++i) data.push_back(static_cast<char>(bits >> 8 * i & 255));
        return *this;
    }
    template <class T>
    Bytes& put_big_endian(T value)
    {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof value);
        for (std::size_t i = sizeof value; i-- > 0;) data.push_back(static_cast<char>(bits >> 8 * i & 255));
        return *this;
    }
    // Text in a field of `width` bytes.
    Bytes& text(const std::string& value, std::size_t width)
    {
        for (std::size_t i = 0; i < width; ++i) data.push_back(i < value.size() ? value[i] : '\0');
        return *this;
    }
    Bytes& raw(const std::string& value)
    {
        data += value;
        return *this;
    }
    template <class T>
    void overwrite(std::size_t at, T value)
    {
        Bytes one;
        one.put(value);
        data.replace(at, sizeof value, one.data);
    }

    std::string data;
};

inline std::filesystem::path write_file(const std::filesystem::path& path, const std::string& data)
{
    // Some file systems flush a truncated and rewritten file to disk, and tests do that thousands of times.
    std::filesystem::remove(path);
    std::ofstream file(path, std::ios::binary);
    file.write(data.data(), static_cast<std::streamsize>(data.size()));
    if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
    return path;
}

inline std::string read_bytes(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

// All points of a file in one batch.
struct Whole {
    FileInfo info;
    PointBatch points;

    double value(const std::string& name, std::size_t point, std::uint32_t component = 0) const
    {
        const auto i = info.schema.find(name);
        if (!i) throw std::runtime_error("no attribute " + name);
        return points.attributes[*i].value(point, component);
    }
    template <class T>
    T raw(const std::string& name, std::size_t point, std::uint32_t component = 0) const
    {
        const auto i = info.schema.find(name);
        if (!i) throw std::runtime_error("no attribute " + name);
        return points.attributes[*i].as<T>()[point * info.schema[*i].components + component];
    }
    Vec3d position(std::size_t i) const
    {
        if (points.gridded)
            return info.grid->to_source(Vec3i{points.grid_xyz[0][i], points.grid_xyz[1][i], points.grid_xyz[2][i]});
        return {points.xyz[0][i], points.xyz[1][i], points.xyz[2][i]};
    }
};

inline void append(PointBatch& all, const PointBatch& more)
{
    const std::size_t before = all.size;
    all.resize(before + more.size);
    for (std::size_t a = 0; a < 3; ++a) {
        if (more.gridded)
            std::copy(more.grid_xyz[a].begin(), more.grid_xyz[a].end(),
                      all.grid_xyz[a].begin() + static_cast<std::ptrdiff_t>(before));
        else
            std::copy(more.xyz[a].begin(), more.xyz[a].end(), all.xyz[a].begin() + static_cast<std::ptrdiff_t>(before));
    }
    for (std::size_t i = 0; i < more.attributes.size(); ++i)
        std::memcpy(all.attributes[i].data() + before * all.attributes[i].point_bytes(), more.attributes[i].data(),
                    more.attributes[i].bytes());
}

inline Whole read_whole(PointReader& reader, std::size_t batch_points = default_batch_points)
{
    Whole whole;
    whole.info = reader.info();
    whole.points.reset(whole.info.schema, whole.info.grid.has_value(), 0);
    PointBatch batch;
    double fraction = 0;
    while (reader.read(batch, batch_points)) {
        EXPECT_GT(batch.size, 0u);
        EXPECT_LE(batch.size, batch_points);
        EXPECT_EQ(batch.gridded, whole.info.grid.has_value());
        EXPECT_EQ(batch.attributes.size(), whole.info.schema.size());
        EXPECT_GE(reader.fraction_read(), fraction);
        fraction = reader.fraction_read();
        append(whole.points, batch);
    }
    EXPECT_EQ(batch.size, 0u);
    EXPECT_EQ(reader.fraction_read(), 1.0);
    EXPECT_FALSE(reader.read(batch, batch_points)) << "the end stays the end";
    if (whole.info.points_known) {
        EXPECT_EQ(whole.points.size, whole.info.points);
    }
    return whole;
}

inline Whole read_whole(const std::filesystem::path& path, std::size_t batch_points = default_batch_points)
{
    return read_whole(*open_reader(path), batch_points);
}

inline bool mentions(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

inline bool any_mentions(const std::vector<std::string>& texts, const std::string& part)
{
    for (const std::string& text : texts)
        if (mentions(text, part)) return true;
    return false;
}

}  // namespace pcm::test
