// Points of numpy arrays as a cloud that is read.
#pragma once

#include "pcm/io/reader.h"

#include <pybind11/numpy.h>

#include <string>
#include <utility>
#include <vector>

namespace pcm::python {

// Keeps the arrays; reads without the interpreter's lock. Positions of float32 are recorded as such, so that the tree
// gives back the same numbers.
class ArrayReader final : public PointReader {
public:
    // `xyz`: (n, 3), float32 or float64. Attributes: (n,) or (n, components). Throws ValueError for other shapes and
    // types, Error(invalid_argument) for a name that no attribute has.
    ArrayReader(const pybind11::array& xyz, const std::vector<std::pair<std::string, pybind11::array>>& attributes);

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return true; }
    void seek(std::uint64_t index) override { next_ = index; }
    double fraction_read() const override { return info_.points ? double(next_) / double(info_.points) : 1; }

private:
    pybind11::array_t<double, pybind11::array::c_style> xyz_;
    std::vector<pybind11::array> values_;
    const double* positions_ = nullptr;
    std::vector<const std::byte*> columns_;
    FileInfo info_;
    std::uint64_t next_ = 0;
};

void add_array_reader(pybind11::module_& module);

}  // namespace pcm::python
