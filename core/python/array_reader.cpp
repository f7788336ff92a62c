#include "pcm/python/array_reader.h"

#include "pcm/build/builder.h"
#include "pcm/python/calls.h"
#include "pcm/python/values.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>

namespace py = pybind11;

namespace pcm::python {

ArrayReader::ArrayReader(const py::array& xyz, const std::vector<std::pair<std::string, py::array>>& attributes)
{
    if (xyz.ndim() != 2 || xyz.shape(1) != 3)
        throw py::value_error("xyz is an array of the shape (points, 3), not of " +
                              py::str(xyz.attr("shape")).cast<std::string>());
    const bool single = xyz.dtype().equal(dtype_of(ScalarType::f32));
    xyz_ = decltype(xyz_)::ensure(xyz);
    if (!xyz_) throw py::error_already_set();
    positions_ = xyz_.data();
    info_.format = "arrays";
    info_.points = static_cast<std::uint64_t>(xyz.shape(0));
    info_.position_type = single ? ScalarType::f32 : ScalarType::f64;
    for (const auto& [name, values] : attributes) {
        if (values.ndim() < 1 || values.ndim() > 2 || values.shape(0) != xyz.shape(0))
            throw py::value_error(name + " is an array of the shape (points,) or (points, components) with " +
                                  std::to_string(xyz.shape(0)) + " points, not of " +
                                  py::str(values.attr("shape")).cast<std::string>());
        const auto components = values.ndim() == 2 ? static_cast<std::uint32_t>(values.shape(1)) : 1;
        info_.schema.add({name, type_of(values.dtype(), name), components, 1, 0, ""});
        const py::object native = values.attr("astype")(values.dtype().attr("newbyteorder")("="), "C");
        values_.push_back(py::array::ensure(native, py::array::c_style));
        columns_.push_back(static_cast<const std::byte*>(values_.back().data()));
    }
}

bool ArrayReader::read(PointBatch& batch, std::size_t max_points)
{
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(max_points, info_.points - next_));
    batch.reset(info_.schema, false, count);
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t i = 0; i < count; ++i) batch.xyz[axis][i] = positions_[3 * (next_ + i) + axis];
    for (std::size_t a = 0; a < columns_.size(); ++a) {
        const std::size_t bytes = info_.schema[a].bytes();
        std::memcpy(batch.attributes[a].data(), columns_[a] + next_ * bytes, count * bytes);
    }
    next_ += count;
    return count > 0;
}

void add_array_reader(py::module_& module)
{
    module.def("from_arrays", [](const std::string& path, const py::array& xyz,
                                 const std::vector<std::pair<std::string, py::array>>& attributes, bool overwrite,
                                 py::object progress) {
        ArrayReader points(xyz, attributes);
        Call call(std::move(progress));
        BuildOptions options;
        options.overwrite = overwrite;
        options.progress = call.progress();
        call.run([&] { build_tree(points, {"arrays"}, path, options); });
    });
}

}  // namespace pcm::python
