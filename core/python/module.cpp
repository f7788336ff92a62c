// The module _pcmlab, which the package pcmlab wraps: no one else imports it.
#include "pcm/python/array_reader.h"
#include "pcm/python/calls.h"
#include "pcm/python/cloud.h"
#include "pcm/python/operations.h"

PYBIND11_MODULE(_pcmlab, module)
{
    pcm::python::add_exceptions(module);
    pcm::python::add_cloud(module);
    pcm::python::add_operations(module);
    pcm::python::add_array_reader(module);
}
