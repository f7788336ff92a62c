// What commands take, for programs: JSON, manual pages and completion of the shells, made from the table of operations.
#pragma once

#include "pcm/cli/command_line.h"

#include <optional>
#include <string>
#include <vector>

namespace pcm::cli {

// `words`: a command line. Answers
//     help --json [COMMAND]           the usage of one or all commands
//     help --man [COMMAND]            a manual page of the program or of a command, for man(1)
//     help --completion bash|zsh      a script for the shell
// as text; nothing for any other line. Throws UsageError for an unknown command or shell.
std::optional<std::string> usage_text(const std::vector<std::string>& words, const std::vector<Command>& commands);

}  // namespace pcm::cli
