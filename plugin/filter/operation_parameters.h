// The arguments of an operation as parameters of dialogs and scripts.
#pragma once

#include "pcm/ops/argument.h"
#include "plugin/filter/filter.h"

namespace pcm::host {

// One parameter for each argument that dialogs have, basic ones first: a flag is a bool, a whole number an int (-1:
// none, where there may be none), a number a float (0: none), a size an int in megabytes, a choice an int with choices,
// and all else a text (lists separated by semicolons, numbers by blanks). The help has unit and default.
void add_parameters(const ops::Arguments& arguments, Parameters& parameters);

// Sets the arguments. A script of an earlier version lacks newer parameters: these keep their defaults, and the log
// reports it. An empty tree is that of the current layer. Throws ops::ArgumentError for values that are not allowed,
// and Error(invalid_argument) where there is no such layer.
void set_arguments(ops::Arguments& arguments, const FilterRun& run);

}  // namespace pcm::host
