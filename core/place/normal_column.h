// The normals that a cloud keeps of its points.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/point_batch.h"
#include "pcm/cloud/vector.h"

#include <cmath>
#include <cstddef>
#include <optional>

namespace pcm {

// Where a schema has the attribute `normal`, of three components. Any number of threads.
class NormalColumn {
public:
    explicit NormalColumn(const Schema& schema)
    {
        const auto place = schema.find(attribute_name::normal);
        if (!place || schema[*place].components != 3) return;
        place_ = place;
        scale_ = schema[*place].scale;
        offset_ = schema[*place].offset;
    }

    bool exists() const { return place_.has_value(); }
    std::size_t place() const { return *place_; }  // in the schema; only where it exists
    // Unit, or 0 0 0 for a point without one.
    Vec3d at(const Column& column, std::size_t i) const
    {
        Vec3d n;
        for (std::uint32_t c = 0; c < 3; ++c) n[c] = column.value(i, c) * scale_ + offset_;
        const double size = length(n);
        return size > 0 && std::isfinite(size) ? n / size : Vec3d{};
    }

private:
    std::optional<std::size_t> place_;
    double scale_ = 1, offset_ = 0;
};

}  // namespace pcm
