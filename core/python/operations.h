// The table of operations for Python: each row is a function there.
#pragma once

#include <pybind11/pybind11.h>

namespace pcm::python {

void add_operations(pybind11::module_& module);

}  // namespace pcm::python
