// Values of points as numpy arrays.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/cloud/geometry.h"
#include "pcm/cloud/point_batch.h"

#include <pybind11/numpy.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace pcm::python {

pybind11::dtype dtype_of(ScalarType type);
// Throws ValueError, naming `name`, for a type that no attribute has: text, objects, complex numbers.
ScalarType type_of(const pybind11::dtype& dtype, const std::string& name);

// Arrays of the same values, without a copy: (points, 3), and (points,) or, of several components, (points,
// components).
pybind11::array array_of(std::vector<Vec3d> positions);
pybind11::array array_of(Column column);

// Rows of equal values that grow at the end and become an array without a copy. Grows without the interpreter's lock.
class Rows {
public:
    Rows(ScalarType type, std::size_t components) : type_(type), components_(components) {}

    // Room for that many more rows, whose values the caller sets. Throws std::bad_alloc.
    std::byte* add(std::size_t rows);
    std::size_t row_bytes() const { return size_of(type_) * components_; }
    // An array of shape (rows,), or (rows, components) with several components or where `flat` is false. Takes the
    // values away. Needs the interpreter's lock.
    pybind11::array take(bool flat = true);

private:
    struct Free {
        void operator()(std::byte* bytes) const;
    };
    ScalarType type_;
    std::size_t components_, rows_ = 0, room_ = 0;
    std::unique_ptr<std::byte, Free> bytes_;
};

}  // namespace pcm::python
