// A query with the values of Python, and the points of its chunks as arrays.
#pragma once

#include "pcm/python/calls.h"
#include "pcm/python/values.h"

#include "pcm/point_cloud.h"

#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm::python {

// What a query of Python says, as pcmlab/cloud.py hands it over. Regions and conditions are text, as on the command
// line; where no attributes are named, all are read.
struct Wanted {
    std::optional<std::vector<double>> box;  // x0, y0, z0, x1, y1, z1
    std::optional<std::string> region;
    std::optional<std::uint16_t> level;
    std::vector<std::string> where;
    std::optional<std::vector<std::string>> attributes;
};

// Throws Error(invalid_argument) for a region or condition that cannot be read, and for a box without inside.
Query query_of(const Wanted& wanted, const Schema& schema);

// Names, types and components of what a query reads, in its order.
std::vector<Attribute> read_attributes(const Query& query, const Schema& schema);

// Points, gathered chunk by chunk.
class Gathered {
public:
    // `ids`: with the node and the number of each point, which together name it. `own_units`: values are doubles, in
    // the attribute's unit (raw * scale + offset).
    Gathered(std::vector<Attribute> attributes, bool ids, bool own_units);

    void add(const PointView& view);
    // A dict: "xyz", then the attributes by name, then "node" and "number". Empties this. Needs the interpreter's lock.
    pybind11::dict take();

private:
    void add_values(std::size_t attribute, const Column& column, const PointView& view);

    const std::vector<Attribute> attributes_;
    const bool own_units_;
    Rows xyz_;
    std::vector<Rows> values_;
    std::optional<Rows> nodes_, numbers_;
};

}  // namespace pcm::python
