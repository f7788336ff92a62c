// A cloud in memory, read like a file: for tests of code that takes a PointReader.
#pragma once

#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/reader.h"

#include <algorithm>
#include <cstring>
#include <random>
#include <utility>

namespace pcm::test {

struct MemoryCloud {
    FileInfo info;
    PointBatch points;
};

class MemoryReader final : public PointReader {
public:
    explicit MemoryReader(const MemoryCloud& cloud, bool seekable = true) : cloud_(cloud), seekable_(seekable) {}
    const FileInfo& info() const override { return cloud_.info; }
    bool seekable() const override { return seekable_; }
    void seek(std::uint64_t index) override { next_ = static_cast<std::size_t>(index); }
    double fraction_read() const override
    {
        return cloud_.points.size ? static_cast<double>(next_) / static_cast<double>(cloud_.points.size) : 1.0;
    }
    bool read(PointBatch& batch, std::size_t max_points) override
    {
        const PointBatch& from = cloud_.points;
        const std::size_t count = std::min(max_points, from.size - next_);
        shape_batch(batch, cloud_.info.schema, from.gridded, count);
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t i = 0; i < count; ++i) {
                if (from.gridded)
                    batch.grid_xyz[a][i] = from.grid_xyz[a][next_ + i];
                else
                    batch.xyz[a][i] = from.xyz[a][next_ + i];
            }
        for (std::size_t k = 0; k < from.attributes.size() && count; ++k) {
            const std::size_t bytes = from.attributes[k].point_bytes();
            std::memcpy(batch.attributes[k].data(), from.attributes[k].data() + next_ * bytes, count * bytes);
        }
        next_ += count;
        return count > 0;
    }

private:
    const MemoryCloud& cloud_;
    bool seekable_;
    std::size_t next_ = 0;
};

// `count` points of random bytes in every column; float columns hold finite numbers, positions lie within +-`extent`.
inline MemoryCloud random_cloud(const Schema& schema, std::optional<Grid> grid, std::size_t count, std::uint64_t seed,
                                double extent = 1000)
{
    std::mt19937_64 random(seed);
    MemoryCloud cloud;
    cloud.info.format = "in memory";
    cloud.info.points = count;
    cloud.info.schema = schema;
    cloud.info.grid = grid;
    cloud.info.position_type = grid ? ScalarType::i32 : ScalarType::f64;
    cloud.points.reset(schema, grid.has_value(), count);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t i = 0; i < count; ++i) {
            if (grid)
                cloud.points.grid_xyz[a][i] = static_cast<std::int32_t>(unit() * extent / grid->scale[a]);
            else
                cloud.points.xyz[a][i] = unit() * extent;
        }
    for (std::size_t k = 0; k < schema.size(); ++k) {
        Column& column = cloud.points.attributes[k];
        for (std::size_t i = 0; i < count * column.components(); ++i) {
            if (column.type() == ScalarType::f32)
                column.as<float>()[i] = static_cast<float>(unit() * 100);
            else if (column.type() == ScalarType::f64)
                column.as<double>()[i] = unit() * 1e6;
            else
                for (std::size_t b = 0; b < size_of(column.type()); ++b)
                    column.data()[i * size_of(column.type()) + b] = static_cast<std::byte>(random());
        }
    }
    return cloud;
}

inline Vec3d position_of(const PointBatch& batch, const std::optional<Grid>& grid, std::size_t i)
{
    if (batch.gridded) return grid->to_source(Vec3i{batch.grid_xyz[0][i], batch.grid_xyz[1][i], batch.grid_xyz[2][i]});
    return {batch.xyz[0][i], batch.xyz[1][i], batch.xyz[2][i]};
}

// The raw bytes of one point's attribute.
inline std::string bytes_of(const Column& column, std::size_t i)
{
    return std::string(reinterpret_cast<const char*>(column.data()) + i * column.point_bytes(), column.point_bytes());
}

// Reads everything in batches of at most `batch_points` into one cloud.
inline MemoryCloud read_all(PointReader& reader, std::size_t batch_points = 1000)
{
    MemoryCloud cloud;
    cloud.info = reader.info();
    cloud.points.reset(cloud.info.schema, cloud.info.grid.has_value(), 0);
    PointBatch batch;
    while (reader.read(batch, batch_points)) {
        const std::size_t before = cloud.points.size;
        cloud.points.resize(before + batch.size);
        for (std::size_t a = 0; a < 3; ++a) {
            std::copy(batch.grid_xyz[a].begin(), batch.grid_xyz[a].end(),
                      cloud.points.grid_xyz[a].begin() + static_cast<std::ptrdiff_t>(batch.gridded ? before : 0));
            std::copy(batch.xyz[a].begin(), batch.xyz[a].end(),
                      cloud.points.xyz[a].begin() + static_cast<std::ptrdiff_t>(batch.gridded ? 0 : before));
        }
        for (std::size_t k = 0; k < batch.attributes.size(); ++k)
            if (batch.attributes[k].bytes())
                std::memcpy(cloud.points.attributes[k].data() + before * batch.attributes[k].point_bytes(),
                            batch.attributes[k].data(), batch.attributes[k].bytes());
    }
    return cloud;
}

}  // namespace pcm::test
