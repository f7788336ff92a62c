#include "cloud/point_batch.h"

namespace pcm {

double Column::value(std::size_t point, std::uint32_t component) const
{
    const std::size_t i = point * components_ + component;
    switch (type_) {
    case ScalarType::i8: return as<std::int8_t>()[i];
    case ScalarType::u8: return as<std::uint8_t>()[i];
    case ScalarType::i16: return as<std::int16_t>()[i];
    case ScalarType::u16: return as<std::uint16_t>()[i];
    case ScalarType::i32: return as<std::int32_t>()[i];
    case ScalarType::u32: return as<std::uint32_t>()[i];
    case ScalarType::i64: return static_cast<double>(as<std::int64_t>()[i]);
    case ScalarType::u64: return static_cast<double>(as<std::uint64_t>()[i]);
    case ScalarType::f32: return static_cast<double>(as<float>()[i]);
    case ScalarType::f64: return as<double>()[i];
    }
    return 0.0;
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

}  // namespace pcm
