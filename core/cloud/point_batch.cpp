#include "pcm/cloud/point_batch.h"

#include "pcm/cloud/with_type.h"

#include <cstring>

namespace pcm {
namespace {

template <std::size_t Size>
void keep_of_size(std::byte* data, const std::vector<std::uint32_t>& kept)
{
    for (std::size_t i = 0; i < kept.size(); ++i)
        if (kept[i] != i) std::memcpy(data + i * Size, data + kept[i] * Size, Size);
}

template <class T>
void keep_in(std::vector<T>& values, const std::vector<std::uint32_t>& kept)
{
    for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
}

}  // namespace

double Column::value(std::size_t point, std::uint32_t component) const
{
    const std::size_t i = point * components_ + component;
    return with_type(type_, [&](auto zero) { return static_cast<double>(as<decltype(zero)>()[i]); });
}

void PointBatch::reset(const Schema& schema, bool on_grid, std::size_t points)
{
    gridded = on_grid;
    for (std::size_t a = 0; a < 3; ++a) {
        grid_xyz[a].clear();
        xyz[a].clear();
    }
    attributes.clear();
    attributes.reserve(schema.size());
    for (const Attribute& attribute : schema) attributes.emplace_back(attribute);
    resize(points);
}

void PointBatch::resize(std::size_t points)
{
    size = points;
    for (std::size_t a = 0; a < 3; ++a) {
        if (gridded)
            grid_xyz[a].resize(points);
        else
            xyz[a].resize(points);
    }
    for (Column& column : attributes) column.resize(points);
}

void keep_points(Column& column, const std::vector<std::uint32_t>& kept)
{
    std::byte* data = column.data();
    switch (const std::size_t size = column.point_bytes()) {
        case 1:
            keep_of_size<1>(data, kept);
            break;
        case 2:
            keep_of_size<2>(data, kept);
            break;
        case 4:
            keep_of_size<4>(data, kept);
            break;
        case 6:
            keep_of_size<6>(data, kept);
            break;
        case 8:
            keep_of_size<8>(data, kept);
            break;
        case 12:
            keep_of_size<12>(data, kept);
            break;
        default:
            for (std::size_t i = 0; i < kept.size(); ++i)
                if (kept[i] != i) std::memcpy(data + i * size, data + kept[i] * size, size);
    }
    column.resize(kept.size());
}

void keep_points(PointBatch& batch, const std::vector<std::uint32_t>& kept)
{
    for (std::size_t a = 0; a < 3; ++a) {
        if (batch.gridded)
            keep_in(batch.grid_xyz[a], kept);
        else
            keep_in(batch.xyz[a], kept);
    }
    for (Column& column : batch.attributes) keep_points(column, kept);
    batch.resize(kept.size());
}

}  // namespace pcm
