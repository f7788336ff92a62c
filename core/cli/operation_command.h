// A row of the table of operations as a command.
#pragma once

#include "pcm/cli/command_line.h"

#include <string>

namespace pcm::cli {

// Throws std::logic_error where there is no such row.
Command operation_command(const std::string& name);

}  // namespace pcm::cli
