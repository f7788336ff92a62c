// Calls of the library from Python: without the interpreter's lock, with progress, and with Python's exceptions.
#pragma once

#include "pcm/system/progress.h"

#include <pybind11/pybind11.h>

#include <chrono>
#include <exception>
#include <utility>

namespace pcm::python {

// The library's errors become pcmlab.Error, those of arguments pcmlab.ArgumentError.
void add_exceptions(pybind11::module_& module);

// The progress of one call. `callback` is None or takes (fraction, stage); it cancels by returning False. Ctrl-C
// cancels too. What is raised meanwhile is raised by the call.
class Call {
public:
    explicit Call(pybind11::object callback) : callback_(std::move(callback)) {}

    ProgressFunction progress();

    // Runs `work` without the interpreter's lock. Throws what it throws, or what the callback has raised.
    template <class Work>
    void run(const Work& work)
    {
        try {
            const pybind11::gil_scoped_release released;
            work();
        } catch (...) {
            raise_what_was_raised();
            throw;
        }
        raise_what_was_raised();
    }

private:
    bool go_on(const ProgressUpdate& update);
    void raise_what_was_raised();

    pybind11::object callback_;
    std::exception_ptr raised_;
};

}  // namespace pcm::python
