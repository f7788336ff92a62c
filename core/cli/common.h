// What the commands share.
#pragma once

#include "pcm/cli/command_line.h"
#include "pcm/system/progress.h"
#include "pcm/system/text.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>

namespace pcm::cli {

using Json = nlohmann::ordered_json;

// Options of every command.
struct Common {
    bool json = false;   // print one JSON object and nothing else
    bool quiet = false;  // no progress
};
void add_common(Options& options, Common& common);

// Shows progress in one line on stderr; nothing where stderr is not a terminal, or with --quiet or --json. Ctrl-C
// cancels the operation, which then removes its unfinished files.
ProgressFunction console_progress(const Common& common);
void end_progress(const Common& common);
// Where a progress line stands on the terminal, begins a new line: what is printed next stands on a line of its own.
void leave_progress_line();

// Prints a command's report, with --json. Paths, names and coordinate systems may hold bytes that are not UTF-8, which
// JSON cannot: U+FFFD replaces them. Never throws for text, so finished work does not end as a failure. The only place
// where commands write JSON.
void print_json(const Json& json);
std::string text_of(const Json& json);  // what it prints

// Ends a command that has done its work: prints the outcome's warnings on stderr and returns the exit code.
int finished(const Outcome& outcome);

}  // namespace pcm::cli
