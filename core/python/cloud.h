// Trees as Python sees them: queries, searches, changes.
#pragma once

#include <pybind11/pybind11.h>

namespace pcm::python {

void add_cloud(pybind11::module_& module);

}  // namespace pcm::python
