// Completion of the command line in shells, made from the table of operations.
#pragma once

#include "pcm/cli/command_line.h"

#include <string>
#include <vector>

namespace pcm::cli {

// A script for "bash", to be sourced, or for "zsh", as the file _pcmlab in a folder of its fpath: commands, their
// options, and the words that an option takes. Throws UsageError for another shell.
std::string completion_for(const std::string& shell, const std::vector<Command>& commands);

}  // namespace pcm::cli
