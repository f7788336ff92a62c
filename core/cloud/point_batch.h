// Points in batches of some ten thousand, a structure of arrays: what readers, builder, queries and filters exchange.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/geometry.h"
#include "pcm/system/page_allocator.h"

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm {

// The values of one attribute for consecutive points: raw scalars, `components` per point, interleaved.
class Column {
public:
    Column() = default;
    Column(ScalarType type, std::uint32_t components) : type_(type), components_(components) {}
    explicit Column(const Attribute& attribute) : Column(attribute.type, attribute.components) {}

    ScalarType type() const { return type_; }
    std::uint32_t components() const { return components_; }
    std::size_t point_bytes() const { return size_of(type_) * components_; }
    std::size_t size() const { return bytes_.size() / (point_bytes() ? point_bytes() : 1); }  // points
    void resize(std::size_t points) { bytes_.resize(points * point_bytes()); }

    std::byte* data() { return bytes_.data(); }
    const std::byte* data() const { return bytes_.data(); }
    std::size_t bytes() const { return bytes_.size(); }

    // Typed view; T must be the scalar that type() names.
    template <class T>
    T* as()
    {
        assert(sizeof(T) == size_of(type_));
        return reinterpret_cast<T*>(bytes_.data());
    }
    template <class T>
    const T* as() const
    {
        assert(sizeof(T) == size_of(type_));
        return reinterpret_cast<const T*>(bytes_.data());
    }
    // One raw scalar, converted to double (i64 and u64 beyond 2^53 are rounded).
    double value(std::size_t point, std::uint32_t component = 0) const;

private:
    ScalarType type_ = ScalarType::u8;
    std::uint32_t components_ = 1;
    PageVector<std::byte> bytes_;
};

// Positions come in one of two forms: integers on a Grid (LAS, LAZ, trees) or doubles (sources with floats, exact).
struct PointBatch {
    std::size_t size = 0;
    bool gridded = false;
    std::array<std::vector<std::int32_t>, 3> grid_xyz;  // filled when gridded: x[], y[], z[]
    std::array<std::vector<double>, 3> xyz;             // filled when not gridded
    std::vector<Column> attributes;                     // as many as the schema has, in its order

    // Shapes the batch for `points` points of `schema`, contents unspecified.
    void reset(const Schema& schema, bool on_grid, std::size_t points);
    // Keeps the shape, changes the number of points.
    void resize(std::size_t points);
};

// Removes all points but those at the indices `kept` (ascending) from a column or a batch, in place.
void keep_points(Column& column, const std::vector<std::uint32_t>& kept);
void keep_points(PointBatch& batch, const std::vector<std::uint32_t>& kept);

}  // namespace pcm
