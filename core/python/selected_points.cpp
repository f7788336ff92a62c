#include "pcm/python/selected_points.h"

#include "pcm/cloud/condition.h"
#include "pcm/cloud/selection.h"

#include <cstring>
#include <utility>

namespace py = pybind11;

namespace pcm::python {

namespace {

template <std::size_t bytes>
void copy_rows(std::byte* out, const std::byte* values, const PointView& view)
{
    for (std::size_t i = 0; i < view.size(); ++i, out += bytes) std::memcpy(out, values + view.index(i) * bytes, bytes);
}

void copy_rows(std::byte* out, const Column& column, const PointView& view)
{
    const std::byte* const values = column.data();
    const std::size_t bytes = column.point_bytes();
    switch (bytes) {
        case 1:
            return copy_rows<1>(out, values, view);
        case 2:
            return copy_rows<2>(out, values, view);
        case 4:
            return copy_rows<4>(out, values, view);
        case 6:
            return copy_rows<6>(out, values, view);
        case 8:
            return copy_rows<8>(out, values, view);
        default:
            for (std::size_t i = 0; i < view.size(); ++i, out += bytes)
                std::memcpy(out, values + view.index(i) * bytes, bytes);
    }
}

Box3d box_of(const std::vector<double>& ends)
{
    if (ends.size() != 6)
        throw Error(ErrorCode::invalid_argument, {}, "a box has six numbers, not " + std::to_string(ends.size()),
                    "write x0, y0, z0, x1, y1, z1");
    return {{ends[0], ends[1], ends[2]}, {ends[3], ends[4], ends[5]}};
}

}  // namespace

Query query_of(const Wanted& wanted, const Schema& schema)
{
    Selection selection;
    if (wanted.box) selection.box = box_of(*wanted.box);
    if (wanted.region) selection.region = parse_region(*wanted.region);
    for (const std::string& condition : wanted.where) selection.where.push_back(parse_condition(condition));
    refuse_impossible_box(selection);
    Query query;
    query.choose(selection);
    query.level = wanted.level;
    if (wanted.attributes)
        query.attributes = *wanted.attributes;
    else
        for (const Attribute& attribute : schema) query.attributes.push_back(attribute.name);
    return query;
}

std::vector<Attribute> read_attributes(const Query& query, const Schema& schema)
{
    std::vector<Attribute> read;
    for (const std::string& name : query.attributes)
        if (const auto place = schema.find(name)) read.push_back(schema[*place]);
    return read;
}

Gathered::Gathered(std::vector<Attribute> attributes, bool ids, bool own_units)
    : attributes_(std::move(attributes)), own_units_(own_units), xyz_(ScalarType::f64, 3)
{
    for (const Attribute& attribute : attributes_)
        values_.emplace_back(own_units_ ? ScalarType::f64 : attribute.type, attribute.components);
    if (!ids) return;
    nodes_.emplace(ScalarType::u32, 1);
    numbers_.emplace(ScalarType::u32, 1);
}

void Gathered::add(const PointView& view)
{
    auto* xyz = reinterpret_cast<double*>(xyz_.add(view.size()));
    for (std::size_t i = 0; i < view.size(); ++i, xyz += 3) {
        const Vec3d p = view.position(i);
        xyz[0] = p[0];
        xyz[1] = p[1];
        xyz[2] = p[2];
    }
    for (std::size_t a = 0; a < attributes_.size(); ++a) add_values(a, view.column(a), view);
    if (!nodes_) return;
    auto* const node = reinterpret_cast<std::uint32_t*>(nodes_->add(view.size()));
    auto* const number = reinterpret_cast<std::uint32_t*>(numbers_->add(view.size()));
    for (std::size_t i = 0; i < view.size(); ++i) {
        node[i] = view.node();
        number[i] = view.number(i);
    }
}

void Gathered::add_values(std::size_t a, const Column& column, const PointView& view)
{
    std::byte* const out = values_[a].add(view.size());
    if (!own_units_) return copy_rows(out, column, view);
    const Attribute& attribute = attributes_[a];
    auto* value = reinterpret_cast<double*>(out);
    for (std::size_t i = 0; i < view.size(); ++i)
        for (std::uint32_t k = 0; k < attribute.components; ++k)
            *value++ = column.value(view.index(i), k) * attribute.scale + attribute.offset;
}

py::dict Gathered::take()
{
    py::dict points;
    points["xyz"] = xyz_.take();
    for (std::size_t a = 0; a < attributes_.size(); ++a) points[py::str(attributes_[a].name)] = values_[a].take();
    if (nodes_) {
        points["node"] = nodes_->take();
        points["number"] = numbers_->take();
    }
    return points;
}

}  // namespace pcm::python
