#include "pcm/python/edited_chunk.h"

#include "pcm/python/copied_rows.h"
#include "pcm/python/values.h"
#include "pcm/system/error.h"

#include <cstring>

namespace py = pybind11;

namespace pcm::python {

namespace {

// The values with a row for each point.
py::array rows_of(const py::object& values, const Attribute& attribute, std::size_t points)
{
    py::tuple shape = py::make_tuple(points);
    if (attribute.components > 1) shape = py::make_tuple(points, attribute.components);
    const py::module_ numpy = py::module_::import("numpy");
    return numpy.attr("broadcast_to")(numpy.attr("asarray")(values), shape);
}

}  // namespace

std::vector<std::string> EditedChunk::names() const
{
    std::vector<std::string> names{"xyz"};
    for (const EditedColumn& column : columns_) names.push_back(column.attribute.name);
    return names;
}

EditView& EditedChunk::open()
{
    if (!view_)
        throw Error(ErrorCode::invalid_argument, {}, "this chunk of points was left",
                    "use a chunk before the next one is taken");
    return *view_;
}

EditedColumn& EditedChunk::column(const std::string& name)
{
    for (EditedColumn& column : columns_)
        if (column.attribute.name == name) return column;
    std::string known;
    for (const std::string& other : names()) known += (known.empty() ? "" : ", ") + other;
    throw py::key_error(name + " is not read by this edit, which has " + known);
}

py::array EditedChunk::get(const std::string& name)
{
    EditView& view = open();
    if (name == "xyz") {
        Rows rows(ScalarType::f64, 3);
        add_positions(rows, view);
        return rows.take();
    }
    const EditedColumn& from = column(name);
    Rows rows(from.attribute.type, from.attribute.components);
    add_values(rows, *view.chunk().attributes[from.slot], view);  // with what was set
    return rows.take();
}

void EditedChunk::set(const std::string& name, const py::object& given)
{
    EditView& view = open();
    if (name == "xyz") throw py::key_error("positions cannot be changed; pcmlab.transform() makes a moved cloud");
    EditedColumn& to = column(name);
    const py::array rows = rows_of(given, to.attribute, view.size());
    const std::size_t place = place_of(to), bytes = to.attribute.bytes();
    const Column before = view.column(place);
    try {
        if (rows.dtype().equal(dtype_of(to.attribute.type))) {
            const auto raw = py::array::ensure(rows, py::array::c_style);
            const auto* values = static_cast<const std::byte*>(raw.data());
            std::byte* const out = view.column(place).data();
            for (std::size_t i = 0; i < view.size(); ++i, values += bytes)
                std::memcpy(out + view.index(i) * bytes, values, bytes);
        } else {
            const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(rows);
            if (!numbers) throw py::error_already_set();
            const double* value = numbers.data();
            for (std::size_t i = 0; i < view.size(); ++i)
                for (std::uint32_t k = 0; k < to.attribute.components; ++k) view.set(i, place, *value++, k);
        }
    } catch (...) {
        view.column(place) = before;
        view.mark_written();
        throw;
    }
    view.mark_written();
}

}  // namespace pcm::python
