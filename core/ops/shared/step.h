// A step of a chain (operation `run`): another operation, whose arguments are written in one word.
#pragma once

#include "pcm/ops/operation.h"

#include <string>

namespace pcm::ops {

// Sets arguments of `operation`, which is the row's, from "16,3" or "16,factor=3" or "method=radius,radius=0.2,label":
// values of the row's arguments for steps, in their order, then KEY=VALUE and names of flags. A list of numbers has its
// commas, "translate=1,2,3", and so has a text: "where=classification=2,6". Throws ArgumentError, without the step's
// name.
void set_step(const Row& row, Operation& operation, const std::string& values);

// "neighbours,factor": what set_step() takes without names.
std::string step_arguments(const Row& row);

// The argument that names what the operation reads, and, null where it has none, the one that names its result.
Argument& input_of_step(Operation& operation);
Argument* output_of_step(Operation& operation);
// Whether the result is a cloud that is written anew, to a file too, instead of a changed tree.
bool writes_new_cloud(Operation& operation);

}  // namespace pcm::ops
