#include "pcm/python/operations.h"

#include "pcm/ops/operation.h"
#include "pcm/ops/shared/chain.h"
#include "pcm/python/calls.h"

#include <pybind11/stl.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace py = pybind11;

namespace pcm::python {

namespace {

// What the functions of Python are made of.
std::string usage()
{
    ops::Json rows = ops::Json::array();
    for (const ops::Row& row : ops::operations()) rows.push_back(ops::usage_of(row, ops::Face::command));
    return rows.dump(-1, ' ', false, ops::Json::error_handler_t::replace);
}

// A value as pcmlab/operations.py hands it over: a switch, or words as on the command line.
struct Given {
    std::string key;
    std::optional<bool> on;
    std::vector<std::string> words;
};

void set_arguments(ops::Operation& operation, const std::vector<Given>& given)
{
    for (const Given& value : given) {
        ops::Argument* const argument = operation.arguments().find(value.key);
        if (!argument) throw ops::ArgumentError("there is no argument " + value.key);
        if (value.on)
            argument->set(*value.on);
        else
            argument->set(value.words, value.key);
    }
    for (ops::Argument& argument : operation.arguments().list())
        if (argument.is_in(ops::Face::command) && argument.is_required() && !argument.is_given())
            throw ops::ArgumentError(argument.key() + " is needed");
}

// The answer as JSON, and its text.
py::tuple run(const std::string& name, const std::vector<std::pair<std::string, py::object>>& values,
              py::object progress)
{
    const ops::Row* const row = ops::find_operation(name);
    if (!row) throw ops::ArgumentError("there is no operation " + name);
    std::vector<Given> given;
    for (const auto& [key, value] : values) {
        Given one{key, {}, {}};
        if (py::isinstance<py::bool_>(value))
            one.on = value.cast<bool>();
        else
            one.words = value.cast<std::vector<std::string>>();
        given.push_back(std::move(one));
    }
    const auto operation = row->make();
    set_arguments(*operation, given);
    Call call(std::move(progress));
    ops::Context context;
    context.progress = call.progress();
    ops::Result result;
    call.run([&] { result = ops::run_on_files_too(*row, *operation, context); });
    return py::make_tuple(ops::json_of(row->name, result).dump(-1, ' ', false, ops::Json::error_handler_t::replace),
                          ops::all_lines(result), result.good);
}

}  // namespace

void add_operations(py::module_& module)
{
    module.def("usage", &usage);
    module.def("run", &run);
    module.def("version", &ops::version);
}

}  // namespace pcm::python
