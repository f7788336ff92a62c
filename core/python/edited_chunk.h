// One chunk of points that are being changed, from Python.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/query/edit_cursor.h"

#include <pybind11/numpy.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace pcm::python {

struct EditedColumn {
    Attribute attribute;
    std::size_t slot = 0;  // in the schema
};

// Valid until the next chunk is taken, or the edit ends; then every call throws Error(invalid_argument). What is set is
// handed to the cloud at once.
class EditedChunk {
public:
    EditedChunk(EditView view, std::vector<EditedColumn> columns) : view_(std::move(view)), columns_(std::move(columns))
    {
    }

    std::size_t size() const { return view_ ? view_->size() : 0; }
    std::vector<std::string> names() const;
    // A copy: "xyz" or an attribute that the edit reads. Throws KeyError for another name.
    pybind11::array get(const std::string& name);
    // Sets the raw values of an attribute, from an array with a row for each point, or from what numpy spreads over
    // them. Throws KeyError for another name, and Error(invalid_argument) for a value that the attribute's type cannot
    // hold; then none of the values is set.
    void set(const std::string& name, const pybind11::object& values);
    void end() { view_.reset(); }

private:
    EditView& open();
    EditedColumn& column(const std::string& name);
    std::size_t place_of(const EditedColumn& column) const
    {
        return static_cast<std::size_t>(&column - columns_.data());
    }

    std::optional<EditView> view_;
    std::vector<EditedColumn> columns_;
};

}  // namespace pcm::python
