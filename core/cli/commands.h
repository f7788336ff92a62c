// The commands of pcmlab.
#pragma once

#include "pcm/cli/command_line.h"

#include <vector>

namespace pcm::cli {

// In the order of the help.
const std::vector<Command>& commands();

}  // namespace pcm::cli
