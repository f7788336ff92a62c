#include "pcm/python/values.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

namespace py = pybind11;

namespace pcm::python {

py::dtype dtype_of(ScalarType type)
{
    switch (type) {
        case ScalarType::i8:
            return py::dtype::of<std::int8_t>();
        case ScalarType::u8:
            return py::dtype::of<std::uint8_t>();
        case ScalarType::i16:
            return py::dtype::of<std::int16_t>();
        case ScalarType::u16:
            return py::dtype::of<std::uint16_t>();
        case ScalarType::i32:
            return py::dtype::of<std::int32_t>();
        case ScalarType::u32:
            return py::dtype::of<std::uint32_t>();
        case ScalarType::i64:
            return py::dtype::of<std::int64_t>();
        case ScalarType::u64:
            return py::dtype::of<std::uint64_t>();
        case ScalarType::f32:
            return py::dtype::of<float>();
        default:
            return py::dtype::of<double>();
    }
}

ScalarType type_of(const py::dtype& dtype, const std::string& name)
{
    // Asked of numpy: the structure that pybind11 2.10 reads is that of numpy 1.
    const auto size = dtype.attr("itemsize").cast<std::size_t>();
    const auto kind = dtype.attr("kind").cast<std::string>();
    for (const ScalarType type : {ScalarType::i8, ScalarType::u8, ScalarType::i16, ScalarType::u16, ScalarType::i32,
                                  ScalarType::u32, ScalarType::i64, ScalarType::u64, ScalarType::f32, ScalarType::f64})
        if (size_of(type) == size && dtype_of(type).attr("kind").cast<std::string>() == kind) return type;
    throw py::value_error(name + ": values of the type " + py::repr(dtype).cast<std::string>() +
                          " cannot be kept: an attribute has integers of 8 to 64 bits, float32 or float64");
}

void Rows::Free::operator()(std::byte* bytes) const { std::free(bytes); }

std::byte* Rows::add(std::size_t rows)
{
    if (rows_ + rows > room_ || !bytes_) {
        // realloc moves large blocks by their pages: no value is copied.
        room_ = std::max({rows_ + rows, room_ + room_ / 2, std::size_t(1)});
        auto* const grown = static_cast<std::byte*>(std::realloc(bytes_.get(), room_ * row_bytes()));
        if (!grown) throw std::bad_alloc();
        static_cast<void>(bytes_.release());
        bytes_.reset(grown);
    }
    std::byte* const added = bytes_.get() + rows_ * row_bytes();
    rows_ += rows;
    return added;
}

py::array Rows::take(bool flat)
{
    if (!bytes_) add(0);
    if (void* const smaller = std::realloc(bytes_.get(), std::max<std::size_t>(1, rows_ * row_bytes()))) {
        static_cast<void>(bytes_.release());
        bytes_.reset(static_cast<std::byte*>(smaller));
    }
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows_)}, strides{static_cast<py::ssize_t>(row_bytes())};
    if (components_ > 1 || !flat) {
        shape.push_back(static_cast<py::ssize_t>(components_));
        strides.push_back(static_cast<py::ssize_t>(size_of(type_)));
    }
    std::byte* const values = bytes_.get();
    const py::capsule owner(values, [](void* bytes) { std::free(bytes); });
    static_cast<void>(bytes_.release());
    rows_ = room_ = 0;
    return py::array(dtype_of(type_), shape, strides, values, owner);
}

}  // namespace pcm::python
