// A row of the table of operations as a command.
#pragma once

#include "pcm/cli/command_line.h"
#include "pcm/ops/operation.h"

#include <functional>
#include <string>
#include <vector>

namespace pcm::cli {

// Sets what operations need OpenGL for: the functions of the context that draw and compute with it. `words` is the
// command line from the command's name on, for a program that does not draw itself but starts another.
using OpenGLSetup = std::function<void(ops::Context& context, const std::vector<std::string>& words)>;

// The row must outlive the command.
Command operation_command(const ops::Row& row, const OpenGLSetup& set_up_opengl);

}  // namespace pcm::cli
