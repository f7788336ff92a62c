#include "pcm/cloud/point_batch.h"

#include "pcm/cloud/with_type.h"

namespace pcm {

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

}  // namespace pcm
