#include "pcm/python/calls.h"

#include "pcm/ops/argument.h"
#include "pcm/system/error.h"

#include <string>

namespace py = pybind11;

namespace pcm::python {

namespace {

PyObject* error_type = nullptr;
PyObject* argument_error_type = nullptr;

void raise(const Error& error)
{
    const py::object type = py::reinterpret_borrow<py::object>(error_type);
    const py::object raised = type(error.what());
    raised.attr("code") = name_of(error.code());
    raised.attr("path") = error.path().string();
    raised.attr("hint") = error.hint();
    raised.attr("is_done") = error.is_done();
    PyErr_SetObject(error_type, raised.ptr());
}

PyObject* new_type(py::module_& module, const char* name, const char* help, PyObject* base)
{
    PyObject* const type = PyErr_NewExceptionWithDoc(("pcmlab." + std::string(name)).c_str(), help, base, nullptr);
    if (!type) throw py::error_already_set();
    module.add_object(name, type);
    return type;
}

}  // namespace

void add_exceptions(py::module_& module)
{
    error_type = new_type(module, "Error",
                          "A failure, with what is wrong, where, and what to do. code: 'not_found', 'permission', "
                          "'no_space', 'io', 'bad_format', 'truncated', 'corrupt', 'not_a_tree', 'interrupted_build', "
                          "'exists', 'unsupported', 'cancelled' or 'invalid_argument'; path: the file or folder, or "
                          "''; hint: what to do, or ''; is_done: True where the result is in place all the same and "
                          "the call is not to be repeated.",
                          PyExc_RuntimeError);
    argument_error_type =
        new_type(module, "ArgumentError", "Arguments that make no sense as given, or together.", PyExc_ValueError);
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const Error& error) {
            raise(error);
        } catch (const ops::ArgumentError& error) {
            PyErr_SetString(argument_error_type, error.what());
        }
    });
}

ProgressFunction Call::progress()
{
    return [this](const ProgressUpdate& update) { return go_on(update); };
}

void Call::raise_what_was_raised()
{
    if (raised_) std::rethrow_exception(std::exchange(raised_, nullptr));
}

bool Call::go_on(const ProgressUpdate& update)
{
    const py::gil_scoped_acquire locked;
    if (raised_) return false;
    try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (callback_.is_none()) return true;
        return !callback_(update.fraction, std::string(update.stage)).is(py::bool_(false));
    } catch (...) {
        raised_ = std::current_exception();
        return false;
    }
}

}  // namespace pcm::python
